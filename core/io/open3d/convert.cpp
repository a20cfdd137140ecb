#include "core/io/open3d/convert.hpp"

#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/LineSet.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>

#include <cmath>
#include <cstring>

#include "core/io/cloud_files/cloud_formats.hpp"
#include "core/model/error.hpp"
#include "core/planes/outline/outline.hpp"

namespace planescope::open3d {
namespace {

using ::open3d::camera::PinholeCameraIntrinsic;
using ::open3d::geometry::LineSet;
using ::open3d::geometry::PointCloud;
using ::open3d::geometry::RGBDImage;
using ::open3d::geometry::TriangleMesh;
using RawImage = ::open3d::geometry::Image;

constexpr std::uint16_t kNoCount = 65535;

bool is_image(const RawImage& image, int channels, int bytes_per_channel) {
  return image.HasData() && image.num_of_channels_ == channels &&
         image.bytes_per_channel_ == bytes_per_channel;
}

std::uint16_t count_of(float depth_m, double unit_m) {
  const double count = std::round(depth_m / unit_m);
  return count > 0 && count < kNoCount ? static_cast<std::uint16_t>(count) : std::uint16_t{0};
}

Image16 depth_of(const RawImage& raw, double unit_m) {
  Image16 depth(raw.width_, raw.height_);
  if (is_image(raw, 1, 2)) {
    std::memcpy(depth.data.data(), raw.data_.data(), raw.data_.size());
  } else if (is_image(raw, 1, 4)) {
    for (int v = 0; v < raw.height_; ++v)
      for (int u = 0; u < raw.width_; ++u)
        depth.at(u, v) = count_of(*raw.PointerAt<float>(u, v), unit_m);
  } else {
    throw Error("Open3D image: depth has " + std::to_string(raw.num_of_channels_) +
                " channels of " + std::to_string(raw.bytes_per_channel_) +
                " bytes, expected one of floats or of 16 bits");
  }
  return depth;
}

}  // namespace

PinholeCameraIntrinsic to_open3d(const Intrinsics& k) {
  if (k.distortion != Distortion::none)
    throw Error("intrinsics: lens distortion, which Open3D's camera does not have");
  return {k.width, k.height, k.fx, k.fy, k.cx, k.cy};
}

Intrinsics from_open3d(const PinholeCameraIntrinsic& camera) {
  const auto [fx, fy] = camera.GetFocalLength();
  const auto [cx, cy] = camera.GetPrincipalPoint();
  return {camera.width_, camera.height_, fx, fy, cx, cy, Distortion::none, {}};
}

RGBDImage to_open3d(const Frame& frame) {
  RGBDImage image;
  const Image16& depth = frame.depth;
  image.depth_.Prepare(depth.width, depth.height, 1, sizeof(float));
  for (int v = 0; v < depth.height; ++v)
    for (int u = 0; u < depth.width; ++u) {
      const std::uint16_t count = depth.at(u, v);
      *image.depth_.PointerAt<float>(u, v) =
          count == kNoCount ? 0.0f : static_cast<float>(count * frame.depth_unit_m);
    }
  const Image8& color = frame.color;
  if (frame.color_aligned && color.channels == 3 && color.pixels() == depth.pixels()) {
    image.color_.Prepare(color.width, color.height, 3, 1);
    std::memcpy(image.color_.data_.data(), color.data.data(), color.data.size());
  }
  return image;
}

Frame from_open3d(const RGBDImage& image,
                  const PinholeCameraIntrinsic& camera,
                  double depth_unit_m) {
  const RawImage& raw = image.depth_;
  if (raw.width_ != camera.width_ || raw.height_ != camera.height_)
    throw Error("Open3D image: depth is " + std::to_string(raw.width_) + "x" +
                std::to_string(raw.height_) + ", its camera is for " +
                std::to_string(camera.width_) + "x" + std::to_string(camera.height_));
  Frame frame;
  frame.depth = depth_of(raw, depth_unit_m);
  frame.depth_unit_m = depth_unit_m;
  frame.intrinsics = from_open3d(camera);
  if (is_image(image.color_, 3, 1)) {
    frame.color = Image8(image.color_.width_, image.color_.height_, 3);
    frame.color.data = image.color_.data_;
    frame.color_aligned = frame.color.pixels() == frame.depth.pixels();
    if (frame.color_aligned) frame.color_intrinsics = frame.intrinsics;
  }
  return frame;
}

PointCloud to_open3d(const PointSet& set) {
  PointCloud cloud;
  cloud.points_.reserve(set.points.size());
  for (const Vec3f& p : set.points) cloud.points_.push_back(set.origin + p.cast<double>());
  for (std::size_t i = 0; i + 2 < set.rgb.size(); i += 3)
    cloud.colors_.push_back(Vec3d(set.rgb[i], set.rgb[i + 1], set.rgb[i + 2]) / 255);
  return cloud;
}

PointSet from_open3d(const PointCloud& cloud) {
  using io::Scalar;
  std::vector<io::CloudField> fields = {{"x", Scalar::f64}, {"y", Scalar::f64}, {"z", Scalar::f64}};
  if (cloud.HasColors())
    fields.insert(fields.end(), {{"r", Scalar::f64}, {"g", Scalar::f64}, {"b", Scalar::f64}});
  io::CloudBuilder builder("Open3D cloud", fields);
  builder.reserve(cloud.points_.size());
  std::vector<double> values(fields.size());
  for (std::size_t i = 0; i < cloud.points_.size(); ++i) {
    Vec3d::Map(values.data()) = cloud.points_[i];
    if (cloud.HasColors()) Vec3d::Map(values.data() + 3) = cloud.colors_[i];
    builder.add(values);
  }
  return builder.finish();
}

PointCloud to_open3d(const planes::Cloud& cloud) {
  PointSet set;
  set.origin = cloud.origin;
  set.points = cloud.points;
  return to_open3d(set);
}

std::vector<PointCloud> planes_to_open3d(const planes::FrameResult& result) {
  std::vector<PointCloud> planes(result.segmentation.planes.size());
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    if (result.plane_of[i] <= 0) continue;
    const auto plane = static_cast<std::size_t>(result.plane_of[i]) - 1;
    planes[plane].points_.push_back(result.cloud.origin + result.cloud.points[i].cast<double>());
    planes[plane].normals_.push_back(result.segmentation.planes[plane].fit.normal);
  }
  return planes;
}

LineSet outlines_to_open3d(std::span<const Polygon> polygons) {
  LineSet lines;
  for (const Polygon& polygon : polygons) {
    if (polygon.size() < 3) continue;
    const int first = static_cast<int>(lines.points_.size());
    const int corners = static_cast<int>(polygon.size());
    lines.points_.insert(lines.points_.end(), polygon.begin(), polygon.end());
    for (int i = 0; i < corners; ++i)
      lines.lines_.emplace_back(first + i, first + (i + 1) % corners);
  }
  return lines;
}

TriangleMesh faces_to_open3d(std::span<const Polygon> polygons) {
  TriangleMesh mesh;
  for (const Polygon& polygon : polygons) {
    if (polygon.size() < 3) continue;
    const int first = static_cast<int>(mesh.vertices_.size());
    mesh.vertices_.insert(mesh.vertices_.end(), polygon.begin(), polygon.end());
    for (int i = 2; i < static_cast<int>(polygon.size()); ++i)
      mesh.triangles_.emplace_back(first, first + i - 1, first + i);
  }
  return mesh;
}

LineSet outlines_to_open3d(std::span<const planes::Outline> outlines) {
  std::vector<Polygon> rings;
  for (const planes::Outline& outline : outlines) {
    const auto add = [&](const planes::PolygonRing& ring) {
      Polygon& corners = rings.emplace_back();
      for (const Vec2d& corner : ring) corners.push_back(outline.world(corner));
    };
    for (const planes::Outline::Part& part : outline.parts) {
      add(part.outer);
      for (const planes::PolygonRing& hole : part.holes) add(hole);
      for (const planes::PolygonRing& hole : part.unknown) add(hole);
    }
  }
  return outlines_to_open3d(std::span<const Polygon>(rings));
}

TriangleMesh mesh_to_open3d(std::span<const planes::Outline> outlines) {
  TriangleMesh all;
  for (const planes::Outline& outline : outlines) {
    const planes::Mesh mesh = planes::mesh_of(outline);
    const Eigen::Vector3i first = Eigen::Vector3i::Constant(static_cast<int>(all.vertices_.size()));
    all.vertices_.insert(all.vertices_.end(), mesh.vertices.begin(), mesh.vertices.end());
    all.vertex_normals_.resize(all.vertices_.size(), outline.basis.u.cross(outline.basis.v));
    for (const auto& [a, b, c] : mesh.triangles)
      all.triangles_.push_back(first + Eigen::Vector3i(a, b, c));
  }
  return all;
}

std::vector<Polygon> outlines_from_open3d(const LineSet& lines) {
  std::vector<int> next(lines.points_.size(), -1);
  for (const Eigen::Vector2i& line : lines.lines_) next[line[0]] = line[1];
  std::vector<Polygon> polygons;
  std::vector<bool> taken(next.size(), false);
  for (int first = 0; first < static_cast<int>(next.size()); ++first) {
    Polygon polygon;
    int i = first;
    for (; i >= 0 && !taken[i]; i = next[i]) {
      taken[i] = true;
      polygon.push_back(lines.points_[i]);
    }
    if (i == first && polygon.size() >= 3) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

}  // namespace planescope::open3d
