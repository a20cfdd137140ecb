#include "core/labels/model/parts.hpp"

#include <algorithm>
#include <limits>

#include "core/model/disjoint_sets.hpp"

namespace planescope::labels {
namespace {

constexpr std::uint16_t kFar = std::numeric_limits<std::uint16_t>::max();

}  // namespace

std::vector<PixelSet> connected_parts(const LabelGrid& grid,
                                      std::span<const std::uint32_t> pixels,
                                      int gap_px) {
  // The pixels grow into the gaps, ring by ring; where two meet on a path short enough they are
  // one. `steps` is the distance into the gap.
  std::vector<std::uint16_t> steps(grid.pixels(), kFar);
  DisjointSets sets(grid.pixels());
  std::vector<std::uint32_t> reached(pixels.begin(), pixels.end());
  for (const std::uint32_t pixel : reached) steps[pixel] = 0;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const std::uint32_t pixel = reached[k];
    if (2 * steps[pixel] >= gap_px) break;  // from here on the other side meets it half way
    for_neighbours(pixel, grid.width, grid.height, [&](std::uint32_t other) {
      if (grid.measured[other] || steps[other] != kFar) return;
      steps[other] = static_cast<std::uint16_t>(steps[pixel] + 1);
      sets.join(other, pixel);
      reached.push_back(other);
    });
  }
  for (const std::uint32_t pixel : reached)
    for_neighbours(pixel, grid.width, grid.height, [&](std::uint32_t other) {
      if (other > pixel || steps[other] == kFar || steps[pixel] + steps[other] > gap_px) return;
      sets.join(pixel, other);
    });

  std::vector<PixelSet> parts;
  std::vector<int> part_of_root(grid.pixels(), -1);
  for (const std::uint32_t pixel : pixels) {
    int& part = part_of_root[sets.root(pixel)];
    if (part < 0) {
      part = static_cast<int>(parts.size());
      parts.emplace_back();
    }
    parts[part].push_back(pixel);
  }
  return parts;
}

}  // namespace planescope::labels
