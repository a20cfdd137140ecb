#pragma once

// Borders of the regions of a label image: rings along pixel edges.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::planes {

/// A pixel corner: the upper left corner of pixel (x, y).
struct Corner {
  int x = 0, y = 0;
  // If two pixels of a label meet only at this corner, the direction of this ring's pixel: -1 or 1.
  int towards_x = 0, towards_y = 0;
  bool operator==(const Corner&) const = default;

  /// Keeps rings apart: where two rings meet at a corner, each is offset a quarter of a pixel to
  /// its own side.
  Vec2d place() const { return {x + 0.25 * towards_x, y + 0.25 * towards_y}; }
};

/// Closed, with a corner at each turn. The region is on the left (image y points down): an outer
/// ring runs down on the left side and up on the right.
struct Ring {
  std::int32_t label = 0;
  std::int32_t part = 0;  // connected region, from 0; a part's holes have the same number
  bool hole = false;
  std::vector<Corner> corners;
};

/// Traces the 4-connected regions of each label above 0. Rings are in raster order of their first
/// pixel, outer rings before their holes. labels: [height * width].
std::vector<Ring> trace_rings(std::span<const std::int32_t> labels, int width, int height);

/// Pixels inside a ring, as runs within a row: x0 <= x < x1.
struct PixelRun {
  int y = 0, x0 = 0, x1 = 0;
};
std::vector<PixelRun> pixels_inside(const Ring& ring);

}  // namespace planescope::planes
