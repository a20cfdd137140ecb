#pragma once

// The depth image behind the points, for what is decided between neighbouring pixels.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::planes {

/// Pixels of columns [x0, x1) and rows [y0, y1).
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// What each pixel of a depth image measured, in raster order.
struct PixelGrid {
  static constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();

  int width = 0, height = 0;         // 0: the points come from no image
  double focal_px = 0;               // pixels per metre on a surface that faces the camera 1 m away
  std::vector<Vec3f> measured;       // where it is [m], in the coordinates of segment()'s points
  std::vector<std::uint32_t> point;  // which of these it went into; kNoPoint: none

  /// A pixel as seen along its ray from the sensor; see inverse_plane.hpp.
  struct Seen {
    Vec3d ray = Vec3d::Zero();  // unit
    double w = 0;               // 1 / distance [1/m]
  };
  Seen seen(std::size_t pixel, const Vec3d& sensor) const {
    const Vec3d to = measured[pixel].cast<double>() - sensor;
    const double w = 1 / std::max(to.norm(), 1e-3);
    return {to * w, w};
  }

  bool empty() const { return point.empty(); }
  bool has(std::size_t pixel) const { return point[pixel] != kNoPoint; }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
  /// The rectangle with a margin, as far as it is in the image.
  Rect around(const Rect& rect, int margin) const {
    return {std::max(0, rect.x0 - margin), std::max(0, rect.y0 - margin),
            std::min(width, rect.x1 + margin), std::min(height, rect.y1 + margin)};
  }
};

}  // namespace planescope::planes
