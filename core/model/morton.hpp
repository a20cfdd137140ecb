#pragma once

// Morton codes: cell numbers of three axes interleaved bit by bit, x in the lowest. In their order
// every cell of every level of an octree is a range.

#include <array>
#include <cstdint>
#include <vector>

namespace planescope {

/// Puts two zero bits between the lower 21 bits of x.
inline std::uint64_t morton_spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

/// Of three cell numbers of at most 21 bits each; and back.
inline std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return morton_spread(x) | morton_spread(y) << 1 | morton_spread(z) << 2;
}
std::array<std::uint32_t, 3> morton_cell(std::uint64_t code);

/// Sorts codes by their lower `bits`, and with them `order`, which begins as 0, 1, 2, ...: stable,
/// so equal codes keep the order of their points.
void sort_codes(std::vector<std::uint64_t>& codes, std::vector<std::uint32_t>& order, int bits);

}  // namespace planescope
