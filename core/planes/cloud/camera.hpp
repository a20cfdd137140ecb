#pragma once

// Rays of pixels, with lens distortion, cached by intrinsics.

#include <cstdint>
#include <memory>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/types.hpp"

namespace planescope::planes {

// Depth image values that are not measurements.
inline constexpr std::uint16_t kNoDepth = 0;
inline constexpr std::uint16_t kFarOutlier = 65535;  // written by RealSense cameras for
                                                     // invalid depth

/// Throws Error naming the frame unless its intrinsics match its depth image and its focal lengths
/// and depth unit are known.
void check_camera(const Frame& frame);

/// Ray of pixel (u, v): (x, y) of (x, y, 1), with lens distortion removed. NaN if the distortion
/// model cannot be inverted at this pixel.
Vec2d pixel_to_ray(const Intrinsics& intrinsics, double u, double v);

/// Projects the ray (x, y, 1) to a pixel; the inverse of pixel_to_ray.
Vec2d ray_to_pixel(const Intrinsics& intrinsics, const Vec2d& ray);

/// pixel_to_ray of the pixel centers of a row: (x[u], y[u], 1).
struct RayRow {
  const double* x = nullptr;
  const double* y = nullptr;
};

/// pixel_to_ray of every pixel center.
class RayTable {
 public:
  explicit RayTable(const Intrinsics& intrinsics);

  /// Valid until the next call with the same `scratch`.
  RayRow row(int v, std::vector<double>& scratch) const;
  /// Whether all rows have the same x values (true without distortion).
  bool same_x() const { return by_axis_; }

 private:
  std::size_t width_ = 0;
  bool by_axis_ = false;       // x depends only on the column and y only on the row, so each is
                               // stored once
  std::vector<double> x_, y_;  // [height x width], or [width] and [height]
};

/// Caches the last camera's table, which all frames of a recording share.
std::shared_ptr<const RayTable> ray_table(const Intrinsics& intrinsics);

/// pixel_to_ray of every pixel center, row-major: [height * width].
std::vector<Vec2d> rays_of_pixels(const Intrinsics& intrinsics);

}  // namespace planescope::planes
