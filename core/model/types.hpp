#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace planescope {

using Vec2d = Eigen::Vector2d;
using Vec3f = Eigen::Vector3f;
using Vec3d = Eigen::Vector3d;
using Mat3d = Eigen::Matrix3d;
/// A rigid transform. T_a_b maps coordinates in frame b to coordinates in frame a.
using Pose = Eigen::Isometry3d;

/// Axis-aligned box; empty until the first point.
struct Bounds {
  Vec3d min = Vec3d::Constant(1e300);
  Vec3d max = Vec3d::Constant(-1e300);

  void add(const Vec3d& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  Bounds& operator+=(const Bounds& other) {
    min = min.cwiseMin(other.min);
    max = max.cwiseMax(other.max);
    return *this;
  }
};

/// Shortest distance between two boxes, 0 where they touch, overlap or are empty.
inline double gap_between(const Bounds& a, const Bounds& b) {
  if (a.min.x() > a.max.x() || b.min.x() > b.max.x()) return 0;
  return (a.min - b.max).cwiseMax(b.min - a.max).cwiseMax(0.0).norm();
}

}  // namespace planescope
