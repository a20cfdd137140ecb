#pragma once

// A handmade octree of (u, v, 1 / z) cells, whose nodes are frustums.

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/model/morton.hpp"
#include "core/planes/segment/octree.hpp"

namespace planescope::test {

/// A camera of 64 x 48 px, away from the origin, that looks along x, slightly to the left and down.
inline planes::ImageSpace small_image_space() {
  planes::ImageSpace space{.fx = 60, .fy = 62, .cx = 31, .cy = 23.5, .root_px = 64};
  Mat3d level;  // x right, y down, z forward, as columns
  level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  space.T_local_camera.linear() =
      Eigen::AngleAxisd(0.2, Vec3d(0, 0.5, 1).normalized()).toRotationMatrix() * level;
  space.T_local_camera.translation() = Vec3d(0.1, -0.2, 0.3);
  return space;
}

/// Pixels of a wall (v), whose distance increases to the right, and of a floor (h) below it.
/// Divided until each cell contains only one of them or is 4 px wide.
inline planes::Octree image_octree() {
  using planes::Case;
  planes::Octree octree;
  octree.image = small_image_space();
  octree.cube.max_depth = 4;
  std::vector<Vec3f> points;
  std::vector<Label> labels;
  for (int v = 0; v < 48; ++v)
    for (int u = 0; u < 64; ++u) {
      const double wall = 0.5 - 0.003 * u, floor = 0.03 * (v - 24);  // 1 / z
      const double rho = std::max(wall, floor);
      octree.image->farthest_m = std::max(octree.image->farthest_m, 1 / rho);
      octree.keys.push_back(morton_code(u / 4, v / 4, static_cast<std::uint32_t>(16 * rho)));
      labels.push_back(floor > wall ? Label::h : Label::v);
      const double x = (u - octree.image->cx) / octree.image->fx;
      const double y = (v - octree.image->cy) / octree.image->fy;
      points.push_back(
          (octree.image->T_local_camera * Vec3d(x / rho, y / rho, 1 / rho)).cast<float>());
    }
  sort_codes(octree.keys, octree.order, 3 * octree.cube.max_depth);
  octree.h_before = {0};
  for (const std::uint32_t i : octree.order) {
    octree.points.push_back(points[i]);
    octree.labels.push_back(labels[i]);
    octree.h_before.push_back(octree.h_before.back() + (labels[i] == Label::h));
  }
  octree.nodes.resize(1);
  octree.nodes[0].end = static_cast<std::uint32_t>(points.size());
  octree.nodes[0].count_h = octree.h_before.back();
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(octree.nodes.size()); ++i) {
    planes::OctreeNode& node = octree.nodes[static_cast<std::size_t>(i)];
    const bool pure = node.count_h == 0 || node.count_h == node.size();
    node.decided = pure ? Case::IV : Case::I;
    node.at_max_depth = !pure && node.depth == octree.cube.max_depth;
    if (!pure && !node.at_max_depth) planes::divide(octree, i);
  }
  return octree;
}

/// The octree's points in their original order.
inline std::vector<Vec3f> measured_points(const planes::Octree& octree) {
  std::vector<Vec3f> points(octree.points.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[octree.order[i]] = octree.points[i];
  return points;
}

}  // namespace planescope::test
