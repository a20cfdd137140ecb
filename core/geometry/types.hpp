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

}  // namespace planescope
