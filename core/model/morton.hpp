#pragma once

// Morton codes: cell indices of three axes interleaved bit by bit, x in the lowest bit. In Morton
// order, every cell of an octree, at any level, is a contiguous range.

#include <array>
#include <cstdint>
#include <vector>

namespace planescope {

/// Inserts two zero bits between the lower 21 bits of x.
inline std::uint64_t morton_spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

/// Converts three cell indices of at most 21 bits each; morton_cell() is the inverse.
inline std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return morton_spread(x) | morton_spread(y) << 1 | morton_spread(z) << 2;
}
std::array<std::uint32_t, 3> morton_cell(std::uint64_t code);

/// Sorts codes by their lower `bits`, and applies the same permutation to `order`, which starts as
/// 0, 1, 2, .... Stable, so equal codes keep their order.
void sort_codes(std::vector<std::uint64_t>& codes, std::vector<std::uint32_t>& order, int bits);

}  // namespace planescope
