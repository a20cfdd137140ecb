#pragma once

// Rays of pixels, with lens distortion, cached by intrinsics.

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

/// pixel_to_ray of the pixel centres of a row: (x[u], y[u], 1).
struct RayRow {
  const double* x = nullptr;
  const double* y = nullptr;
};

/// pixel_to_ray of every pixel centre.
class RayTable {
 public:
  explicit RayTable(const Intrinsics& intrinsics);

  /// Valid until the next call with the same `scratch`.
  RayRow row(int v, std::vector<double>& scratch) const;
  /// Whether all rows have the same x, as they have without distortion.
  bool same_x() const { return by_axis_; }

 private:
  std::size_t width_ = 0;
  bool by_axis_ = false;       // x is that of the column, y that of the row, and none kept twice
  std::vector<double> x_, y_;  // [height x width], or [width] and [height]
};

/// The last camera's is kept: the frames of a recording share it.
std::shared_ptr<const RayTable> ray_table(const Intrinsics& intrinsics);

/// pixel_to_ray of every pixel centre, row-major: [height * width].
std::vector<Vec2d> rays_of_pixels(const Intrinsics& intrinsics);

}  // namespace planescope::planes
