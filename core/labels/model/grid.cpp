#include "core/labels/model/grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/labels/model/depth_surface.hpp"
#include "core/model/error.hpp"
#include "core/planes/cloud/camera.hpp"

namespace planescope::labels {
namespace {

constexpr std::uint16_t kNoDepth = 0;
constexpr std::uint16_t kFarOutlier = 65535;  // what RealSense cameras write for nonsense
constexpr double kLeastCosine = 0.05;         // a surface seen edge-on must not seem endless

void check(const Frame& frame) {
  if (frame.is_cloud())
    throw Error("frame " + frame.name +
                ": is a cloud, whose labels are fields of its own file; expected a depth image");
  const Image16& depth = frame.depth;
  const Intrinsics& k = frame.intrinsics;
  if (depth.empty() || k.width != depth.width || k.height != depth.height)
    throw Error("frame " + frame.name + ": depth is " + std::to_string(depth.width) + "x" +
                std::to_string(depth.height) + ", its intrinsics are for " +
                std::to_string(k.width) + "x" + std::to_string(k.height));
  if (!(k.fx != 0) || !(k.fy != 0) || !(frame.depth_unit_m > 0))
    throw Error("frame " + frame.name +
                ": focal length or depth unit is zero, expected both from the recording or from "
                "--intrinsics and --depth-unit");
}

}  // namespace

LabelGrid make_label_grid(const Frame& frame, const Gravity& gravity) {
  check(frame);
  LabelGrid grid;
  grid.width = frame.depth.width;
  grid.height = frame.depth.height;
  grid.intrinsics = frame.intrinsics;
  grid.gravity = gravity;
  const std::size_t pixels = frame.depth.pixels();
  grid.measured.resize(pixels, 0);
  grid.points.resize(pixels, Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  grid.sigma_m.resize(pixels, 0);

  InverseDepth inverse{grid.width, grid.height, planes::ray_table(frame.intrinsics), {}};
  inverse.per_m.resize(pixels, 0);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint16_t counts = frame.depth.data[i];
    const Vec2d& ray = inverse.rays[i];
    if (counts == kNoDepth || counts == kFarOutlier || std::isnan(ray.x())) continue;
    const double z = counts * frame.depth_unit_m;
    grid.measured[i] = 1;
    grid.points[i] = Vec3d(ray.x() * z, ray.y() * z, z).cast<float>();
    inverse.per_m[i] = 1 / z;
    ++grid.measured_count;
  }
  DepthSurface surface = measure_surface(inverse, std::abs(frame.intrinsics.fx));
  const double count_sigma_m = frame.depth_unit_m / std::sqrt(12.0);  // of rounding to counts
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!grid.measured[i]) continue;
    const double z = 1 / inverse.per_m[i],
                 sigma_z = std::hypot(surface.noise * z * z, count_sigma_m);
    const double stretch = std::sqrt(1 + inverse.rays[i].squaredNorm());  // along the ray
    grid.sigma_m[i] = static_cast<float>(sigma_z * stretch);
  }
  grid.normals = std::move(surface.normals);
  if (frame.color_aligned && frame.color.channels == 3 && frame.color.width == grid.width &&
      frame.color.height == grid.height)
    grid.color = frame.color;
  return grid;
}

double LabelGrid::pixel_area_m2(std::uint32_t pixel, const Vec3d* normal) const {
  if (!measured[pixel]) return 0;
  const Vec3d point = points[pixel].cast<double>();
  const Vec3d facing = normal ? *normal : normals[pixel].cast<double>();
  if (facing.isZero()) return 0;
  // A pixel's cone cuts z^2 / (fx fy) out of a surface that faces along z, and out of another one
  // more by 1 / (normal . ray), where the ray is (x, y, 1).
  const double slant = std::abs(facing.dot(point)) / point.z();
  const double least = kLeastCosine * point.norm() / point.z();
  return point.z() * point.z() / (std::abs(intrinsics.fx * intrinsics.fy) * std::max(slant, least));
}

FrameLabels empty_labels(const LabelGrid& grid, const std::string& depth_sha256) {
  FrameLabels labels;
  labels.depth_sha256 = depth_sha256;
  labels.intrinsics = grid.intrinsics;
  labels.gravity = grid.gravity;
  labels.plane = Image16(grid.width, grid.height);
  labels.hv = Image8(grid.width, grid.height);
  labels.review_state = "unreviewed";
  return labels;
}

}  // namespace planescope::labels
