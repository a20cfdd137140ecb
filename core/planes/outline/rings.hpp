#pragma once

// Where the regions of a label image end: rings along the edges of its pixels.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::planes {

/// A corner of pixels: that of pixel (x, y) on its upper left.
struct Corner {
  int x = 0, y = 0;
  // Where two pixels of a label meet at a corner alone, towards which of them it is meant: -1, 1.
  int towards_x = 0, towards_y = 0;
  bool operator==(const Corner&) const = default;

  /// Rings do not touch: where two meet at a corner, each stays a quarter of a pixel on its side.
  Vec2d place() const { return {x + 0.25 * towards_x, y + 0.25 * towards_y}; }
};

/// Closed, and listed where it turns. The region is on its left (image y is down): an outer ring
/// goes down on the left, up on the right.
struct Ring {
  std::int32_t label = 0;
  std::int32_t part = 0;  // connected region, from 0: a part's holes have its number
  bool hole = false;
  std::vector<Corner> corners;
};

/// Row by row; a region is what one label above 0 is connected by, over edges of pixels, not over
/// their corners. Rings in raster order of their first pixel, an outer one before its holes.
/// labels: [height * width].
std::vector<Ring> trace_rings(std::span<const std::int32_t> labels, int width, int height);

/// The pixels inside a ring, as runs of a row: x0 <= x < x1.
struct PixelRun {
  int y = 0, x0 = 0, x1 = 0;
};
std::vector<PixelRun> pixels_inside(const Ring& ring);

}  // namespace planescope::planes
