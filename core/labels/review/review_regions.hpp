#pragma once

// Regions where two labelings disagree in the same way. Internal to core/labels.

#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// Connected pixels (eight neighbours) of the same pair of planes.
struct PairRegions {
  std::vector<int> of_pixel;      // -1 none
  std::vector<PixelSet> pixels;   // of each
  std::vector<int> thickness_px;  // edge of the largest square inside
  std::vector<std::uint32_t> deepest;
};

/// `pairs`: per pixel a number for the pair of planes that disagree there, 0 where none do.
PairRegions regions_of_pairs(const std::vector<std::uint64_t>& pairs, int width, int height);

}  // namespace planescope::labels
