#pragma once

// Sets of a tile's pixels, a bit each.

#include <algorithm>
#include <cstdint>

#include "core/planes/segment/pixel_reach.hpp"

namespace planescope::planes {

constexpr int kTile = 24;  // [px]; a tile's row with what is in reach of it is a word

/// Pixels of a tile and around it: (0, 0) is kMostReach_px left of and above the tile.
struct PixelSet {
  static constexpr int kSize = kTile + 2 * kMostReach_px;
  static_assert(kSize == 64);
  std::uint64_t rows[kSize] = {};
};
/// Of the tile alone; bits of a row as there.
struct TileSet {
  std::uint64_t rows[kTile] = {};
};

/// The tile's pixels that have one of the set in the square of 2 reach + 1 pixels about them.
inline TileSet near(const PixelSet& set, int reach) {
  std::uint64_t rows[PixelSet::kSize];
  const int begin = kMostReach_px - reach, end = kMostReach_px + kTile + reach;
  std::copy(set.rows + begin, set.rows + end, rows + begin);
  // Each becomes the union of `covered` of them: to the right, then below.
  const int all = 2 * reach + 1;
  for (int covered = 1; covered < all;) {
    const int more = std::min(covered, all - covered);
    for (int y = begin; y < end; ++y) rows[y] |= rows[y] << more;
    covered += more;
  }
  for (int covered = 1; covered < all;) {
    const int more = std::min(covered, all - covered);
    for (int y = begin; y < end - more; ++y) rows[y] |= rows[y + more];
    covered += more;
  }
  TileSet result;
  for (int y = 0; y < kTile; ++y) result.rows[y] = rows[begin + y] >> reach;
  return result;
}

}  // namespace planescope::planes
