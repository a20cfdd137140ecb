#pragma once

// Points along a Z-order (Morton) curve: every cell of every level of an octree is a range of them.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::planes {

inline constexpr int kZBits = 21;  // per axis, at level 0 (the finest); level kZBits is one cell

using ZCell = std::array<std::int32_t, 3>;  // integer coordinates at some level

/// The cube of 2^kZBits cells per axis at level 0 in which the points lie.
struct ZFrame {
  Vec3d min_corner = Vec3d::Zero();
  double cells_per_m = 1;

  Vec3d in_cells(const Vec3f& p) const { return (p.cast<double>() - min_corner) * cells_per_m; }
};

struct ZOrder {
  ZFrame frame;
  std::vector<std::uint64_t> codes;  // ascending, of the cells at level 0
  std::vector<std::uint32_t> order;  // order[i]: the point of codes[i]; equal codes by x, y, z
};

/// `per_cell`: the cells' size is such that at one level the occupied ones hold about so many
/// points each. The codes do not change when the cloud is scaled by a power of two.
ZOrder z_order(std::span<const Vec3f> points, double per_cell);

/// The level whose occupied cells hold about `per_cell` points each.
int z_level(std::span<const std::uint64_t> codes, double per_cell);

}  // namespace planescope::planes
