#pragma once

// Exact nearest neighbors of points in Z-order.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/model/parallel.hpp"
#include "core/model/types.hpp"

namespace planescope::planes {

// Points along a Z-order (Morton) curve: every cell of an octree, at any level, is a range of them.

inline constexpr int kZBits = 21;  // per axis, at level 0 (the finest); level kZBits is one cell

using ZCell = std::array<std::int32_t, 3>;  // integer coordinates at some level

/// The cube that contains the points: 2^kZBits cells per axis at level 0.
struct ZFrame {
  Vec3d min_corner = Vec3d::Zero();
  double cells_per_m = 1;

  Vec3d in_cells(const Vec3f& p) const { return (p.cast<double>() - min_corner) * cells_per_m; }
};

struct ZOrder {
  ZFrame frame;
  std::vector<std::uint64_t> codes;  // ascending codes of level-0 cells
  std::vector<std::uint32_t> order;  // order[i]: point of codes[i]; equal codes sorted by x, y, z
};

/// `per_cell`: chooses the cell size so that at some level the occupied cells contain about this
/// many points each. Scaling the cloud by a power of two does not change the codes.
ZOrder z_order(std::span<const Vec3f> points, double per_cell);

/// Level at which occupied cells contain about `per_cell` points each.
int z_level(std::span<const std::uint64_t> codes, double per_cell);

/// The eight children of one cell, in Z-order.
struct Siblings {
  std::array<std::uint32_t, 9> begin{};  // points begin[i]..begin[i + 1] are in cell i
  std::uint8_t occupied = 0;             // bit i: cell i contains points
};

/// Hash table of all occupied cells from one level upward.
class CellTable {
 public:
  CellTable() = default;
  /// `codes`: ascending; `level`: level of the finest cells in the table.
  CellTable(std::span<const std::uint64_t> codes, int level);

  /// Returns the cells at `level` (below kZBits) whose parent has the code `parent`: a point's code
  /// shifted right by 3 * (level + 1). Below the table's finest level, searches `codes` instead:
  /// the same result, but slower.
  Siblings find(std::span<const std::uint64_t> codes, std::uint64_t parent, int level) const;

 private:
  struct Slot {
    std::uint64_t key = 0;  // 0: free
    Siblings siblings;
  };
  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15 >> shift_);
  }
  void insert(std::uint64_t key, const Siblings& siblings);

  int level_ = kZBits;
  int shift_ = 0;
  std::vector<Slot> slots_;
};

/// Points in Z-order, with a lookup of the points of any cell.
struct CellIndex {
  ZOrder z;
  std::vector<Vec3f> points;
  std::array<std::vector<float>, 3> axes;  // the points by axis; padded, so that whole groups can
                                           // be read
  std::size_t crowd = 0;                   // candidate count above which a smaller cell suffices
  int level = 0;                           // level at which searches begin
  CellTable cells;                         // from `level` upward
};

inline constexpr std::uint32_t kNoNeighbor = std::numeric_limits<std::uint32_t>::max();

/// A cloud sorted along a Z-order curve, then by x, y, z, with exact nearest-neighbor queries. The
/// curve's grid follows the bounds and density of the cloud, so the order does not depend on the
/// order of the input (coincident points are interchangeable). Points must be finite.
class NeighborGrid {
 public:
  /// `k`: number of neighbors that queries will request; determines the cell size.
  NeighborGrid(std::span<const Vec3f> points, int k);

  /// The grid of points 0, rate, 2 rate, ... of this one, in the same order.
  NeighborGrid every(int rate) const;

  std::size_t size() const { return index_.points.size(); }
  std::span<const Vec3f> points() const { return index_.points; }  // in grid order
  /// order()[i]: input index of points()[i]; for a grid made by every(), in the full cloud.
  std::span<const std::uint32_t> order() const { return index_.z.order; }

  /// Finds the k nearest points, including the point itself, for points begin..end of the grid:
  /// [(end - begin) x k] grid indices, ascending in each row, padded with kNoNeighbor if size() <
  /// k. Ties at the k-th distance go to the first in grid order.
  void nearest(int k, std::size_t begin, std::size_t end, std::uint32_t* rows) const;

  /// Finds the grid point nearest to each query: the first in grid order on ties, kNoNeighbor if
  /// the grid is empty. Fastest if consecutive queries are close together.
  void nearest_to(std::span<const Vec3f> queries, std::uint32_t* found) const;

 private:
  NeighborGrid() = default;
  void make_cells();

  int k_ = 1;
  CellIndex index_;
};

}  // namespace planescope::planes
