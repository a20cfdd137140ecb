#pragma once

// Converts Open3D's types to frames, and planes to Open3D's types. Header only: planescope's
// libraries contain no Open3D code, so any version works.

#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/Image.h>
#include <open3d/geometry/LineSet.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>

#include <cmath>

#include "planescope/core.hpp"

namespace planescope {
#ifdef PLANESCOPE_LIBRARY_SOURCE  // planescope itself has types of the same names
namespace v0 {
#else
inline namespace v0 {
#endif
namespace detail {
inline Eigen::Vector3d to_eigen(const Vec3& p) { return {p[0], p[1], p[2]}; }
}  // namespace detail

/// `gravity`: in the cloud's frame; nullopt: -z.
inline Frame from_open3d(const open3d::geometry::PointCloud& cloud,
                         const std::optional<Vec3>& gravity = {}) {
  PointCloud points;
  points.xyz = cloud.points_.empty() ? nullptr : cloud.points_[0].data();
  points.size = cloud.points_.size();
  points.gravity = gravity;
  std::vector<std::uint8_t> rgb;
  if (cloud.HasColors()) {
    for (const Eigen::Vector3d& color : cloud.colors_)
      for (int k = 0; k < 3; ++k)
        rgb.push_back(
            static_cast<std::uint8_t>(std::lround(255 * std::fmin(std::fmax(color[k], 0), 1))));
    points.rgb = rgb.data();
  }
  return points;
}

/// Single-channel depth: 16-bit counts of `unit_m`, or floats [m].
inline Frame from_open3d(const open3d::geometry::Image& depth,
                         const open3d::camera::PinholeCameraIntrinsic& camera,
                         double unit_m = 0.001,
                         const std::optional<Vec3>& gravity = {}) {
  if (depth.num_of_channels_ != 1 ||
      (depth.bytes_per_channel_ != 2 && depth.bytes_per_channel_ != 4))
    throw Error("Open3D image: " + std::to_string(8 * depth.bytes_per_channel_) +
                "-bit values in " + std::to_string(depth.num_of_channels_) +
                (depth.num_of_channels_ == 1 ? " channel" : " channels") +
                "; expected 16-bit counts or floats in one channel");
  if (depth.width_ != camera.width_ || depth.height_ != camera.height_)
    throw Error("Open3D image: " + std::to_string(depth.width_) + "x" +
                std::to_string(depth.height_) + ", but its camera is " +
                std::to_string(camera.width_) + "x" + std::to_string(camera.height_));
  DepthImage image;
  const auto focal = camera.GetFocalLength();
  const auto center = camera.GetPrincipalPoint();
  image.camera.width = depth.width_;
  image.camera.height = depth.height_;
  image.camera.fx = focal.first;
  image.camera.fy = focal.second;
  image.camera.cx = center.first;
  image.camera.cy = center.second;
  image.unit_m = unit_m;
  image.gravity = gravity;
  if (depth.bytes_per_channel_ == 2)
    image.counts = reinterpret_cast<const std::uint16_t*>(depth.data_.data());
  else
    image.meters = reinterpret_cast<const float*>(depth.data_.data());
  return image;
}

/// Measurements on each plane with its normal, world; by id - 1.
inline std::vector<open3d::geometry::PointCloud> planes_to_open3d(const Result& result) {
  const std::vector<Plane>& planes = result.planes();
  std::vector<open3d::geometry::PointCloud> clouds(planes.size());
  const std::vector<Vec3> points = result.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t id = result.plane_of()[i];
    if (id <= 0) continue;
    const std::size_t k = static_cast<std::size_t>(id) - 1;
    clouds[k].points_.push_back(detail::to_eigen(points[i]));
    clouds[k].normals_.push_back(detail::to_eigen(planes[k].normal));
  }
  return clouds;
}

/// Regions covered by the planes, as triangles with the plane's normal, world.
inline open3d::geometry::TriangleMesh mesh_to_open3d(const Result& result) {
  open3d::geometry::TriangleMesh mesh;
  for (const Plane& plane : result.planes()) {
    const Mesh part = result.mesh(plane.id);
    const int first = static_cast<int>(mesh.vertices_.size());
    for (const Vec3& vertex : part.vertices) {
      mesh.vertices_.push_back(detail::to_eigen(vertex));
      mesh.vertex_normals_.push_back(detail::to_eigen(plane.normal));
    }
    for (const std::array<int, 3>& t : part.triangles)
      mesh.triangles_.emplace_back(first + t[0], first + t[1], first + t[2]);
  }
  return mesh;
}

/// All rings of the planes' outlines, including holes and unknown areas, world.
inline open3d::geometry::LineSet outlines_to_open3d(const Result& result) {
  open3d::geometry::LineSet lines;
  for (const Plane& plane : result.planes()) {
    const auto add = [&](const Outline::Ring& ring) {
      const int first = static_cast<int>(lines.points_.size());
      const int n = static_cast<int>(ring.size());
      for (const Vec2& corner : ring)
        lines.points_.push_back(detail::to_eigen(plane.outline.world(corner)));
      for (int i = 0; i < n; ++i) lines.lines_.emplace_back(first + i, first + (i + 1) % n);
    };
    for (const Outline::Part& part : plane.outline.parts) {
      add(part.outer);
      for (const Outline::Ring& hole : part.holes) add(hole);
      for (const Outline::Ring& hole : part.unknown) add(hole);
    }
  }
  return lines;
}

}  // namespace v0
}  // namespace planescope
