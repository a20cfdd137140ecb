#pragma once

// Connected parts of a set of pixels, across what was not measured. Internal to core/labels.

#include <cstdint>
#include <span>
#include <vector>

#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// Calls visit(neighbour) for the eight pixels around one, fewer at the image's border.
template <typename Visit>
void for_neighbours(std::uint32_t pixel, int width, int height, const Visit& visit) {
  const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
  for (int v = y > 0 ? y - 1 : y; v <= y + 1 && v < height; ++v)
    for (int u = x > 0 ? x - 1 : x; u <= x + 1 && u < width; ++u)
      if (u != x || v != y) visit(static_cast<std::uint32_t>(v * width + u));
}

/// Eight neighbours; parts that at most `gap_px` pixels without a measurement keep apart are one.
/// In order of their first pixels.
std::vector<PixelSet> connected_parts(const LabelGrid& grid,
                                      std::span<const std::uint32_t> pixels,
                                      int gap_px);

}  // namespace planescope::labels
