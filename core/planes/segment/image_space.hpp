#pragma once

// The space that the octree of a depth image divides: pixels u and v, and inverse depth rho = 1 /
// z. A plane in space is a plane in it, and the noise of stereo depth is the same everywhere.

#include <algorithm>

#include "core/model/types.hpp"

namespace planescope::planes {

struct ImageSpace {
  double fx = 0, fy = 0, cx = 0, cy = 0;   // [px], without distortion
  Pose T_local_camera = Pose::Identity();  // camera: x right, y down, z forward
  double root_px = 1024;                   // side of the root in u and v, a power of two
  double px_per_inverse_m = 64;            // a cell of s px is s / 64 1/m high in rho
  double farthest_m = 1;                   // greatest z of the points: cells are drawn up to it

  /// (u, v, rho) [px, px, 1/m] to local coordinates [m], and back. What is beyond `farthest_m`, the
  /// infinitely far rho = 0 as well, comes to that depth.
  Vec3d to_local(const Vec3d& at) const {
    const double z = 1 / std::max(at.z(), 1 / farthest_m);
    return T_local_camera * Vec3d((at.x() - cx) / fx * z, (at.y() - cy) / fy * z, z);
  }
  Vec3d from_local(const Vec3d& point) const {
    const Vec3d p = T_local_camera.inverse() * point;
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy, 1 / p.z()};
  }
};

}  // namespace planescope::planes
