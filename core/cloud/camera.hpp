#pragma once

#include <vector>

#include "core/geometry/types.hpp"
#include "core/recording/frame.hpp"

namespace planescope {

/// Where pixel (u, v) looks: (x, y) of the ray (x, y, 1), lens distortion taken out. NaN where the
/// distortion model cannot be inverted there, so that no ray leads to the pixel.
Vec2d pixel_to_ray(const Intrinsics& intrinsics, double u, double v);

/// The pixel in which the ray (x, y, 1) ends; the inverse of pixel_to_ray.
Vec2d ray_to_pixel(const Intrinsics& intrinsics, const Vec2d& ray);

/// pixel_to_ray of every pixel centre, row-major: [height * width].
std::vector<Vec2d> ray_table(const Intrinsics& intrinsics);

}  // namespace planescope
