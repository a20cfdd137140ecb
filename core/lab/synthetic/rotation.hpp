#pragma once

#include "core/lab/synthetic/trigonometry.hpp"
#include "core/model/types.hpp"

namespace planescope::lab {

/// Rotation by `angle_deg` about a unit axis (Rodrigues), the same on every machine.
inline Mat3d rotation(const Vec3d& axis, double angle_deg) {
  Mat3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Mat3d::Identity() + sin_deg(angle_deg) * cross + (1 - cos_deg(angle_deg)) * cross * cross;
}

}  // namespace planescope::lab
