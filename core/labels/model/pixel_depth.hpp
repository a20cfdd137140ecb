#pragma once

// Sets of pixels by distance in the image. Internal to core/labels.

#include <span>
#include <vector>

#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// The pixel of a set that is farthest from all that is not in it; of several the first. The
/// image's border counts as outside. `pixels` is not empty.
std::uint32_t deepest_pixel(std::span<const std::uint32_t> pixels, int width, int height);

/// Per pixel of the image: 1 where one of the set is at most `distance_px` columns and rows away.
std::vector<std::uint8_t> pixels_near(std::span<const std::uint32_t> pixels,
                                      int width,
                                      int height,
                                      int distance_px);

/// Parts of a set that lie at least `gap_px` (even) columns or rows apart, whatever lies between.
std::vector<PixelSet> parts_apart(std::span<const std::uint32_t> pixels,
                                  int width,
                                  int height,
                                  int gap_px);

}  // namespace planescope::labels
