#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/types.hpp"

namespace planescope::planes {

// Counts of a depth image that are no measurement.
inline constexpr std::uint16_t kNoDepth = 0;
inline constexpr std::uint16_t kFarOutlier = 65535;  // what RealSense cameras write for nonsense

/// Throws Error naming the frame unless its intrinsics are for its depth image, and focal lengths
/// and depth unit are known.
void check_camera(const Frame& frame);

/// The ray of pixel (u, v): (x, y) of (x, y, 1), with lens distortion removed. NaN where the
/// distortion model cannot be inverted, so that no ray leads to the pixel.
Vec2d pixel_to_ray(const Intrinsics& intrinsics, double u, double v);

/// The pixel where the ray (x, y, 1) lands; the inverse of pixel_to_ray.
Vec2d ray_to_pixel(const Intrinsics& intrinsics, const Vec2d& ray);

/// pixel_to_ray of every pixel centre, row-major: [height * width]. The last camera's is kept: the
/// frames of a recording share it.
using RayTable = std::shared_ptr<const std::vector<Vec2d>>;
RayTable ray_table(const Intrinsics& intrinsics);

}  // namespace planescope::planes
