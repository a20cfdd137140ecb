#pragma once

#include <optional>
#include <string>

#include "core/recording/frame.hpp"

namespace planescope {

enum class GravityMode : std::uint8_t { automatic, fixed, imu, estimate };

struct GravityOptions {
  GravityMode mode = GravityMode::automatic;
  Vec3d direction = Vec3d(0, 1, 0);  // for `fixed`, sensor frame, any length > 0
  double max_tilt_deg = 60;  // prior of the estimate: camera tilt (pitch or roll) stays below
};

/// Parses auto | X,Y,Z | imu | estimate. Throws Error on anything else.
GravityOptions parse_gravity(const std::string& text);

/// Orthogonal-structure vote over plane normals under the camera-tilt prior of `options`
/// (depth frames only). nullopt where the scene does not tell.
std::optional<Gravity> estimate_gravity(const Frame& frame, const GravityOptions& options);

/// Takes the first that exists: option, sidecar, IMU, estimate; clouds: option, else -z, assumed.
/// Throws Error that says how to give gravity where even the estimate fails.
Gravity resolve_gravity(const Frame& frame, const GravityOptions& options);

}  // namespace planescope
