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

// Points along a Z-order (Morton) curve: every cell of every level of an octree is a range of them.

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

/// The eight cells that make up a cell of the level above, in Z-order.
struct Siblings {
  std::array<std::uint32_t, 9> begin{};  // points begin[i]..begin[i + 1] lie in cell i
  std::uint8_t occupied = 0;             // bit i: cell i holds points
};

/// Finds the points of cells: a hash table of all that are occupied, from some level upwards.
class CellTable {
 public:
  CellTable() = default;
  /// `codes`: ascending; `level`: of the finest cells in the table.
  CellTable(std::span<const std::uint64_t> codes, int level);

  /// The cells of `level` (below kZBits) in the cell of the level above that has this code, which
  /// is that of its points shifted right by 3 * (level + 1). Below the table's own level they are
  /// searched for in the codes it was made from: the same answer, but slower.
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

/// Points in Z-order and the way to those of any cell.
struct CellIndex {
  ZOrder z;
  std::vector<Vec3f> points;
  std::array<std::vector<float>, 3> axes;  // the same; longer, so that whole groups may be read
  std::size_t crowd = 0;                   // candidates that are too many: a smaller cell will do
  int level = 0;                           // where searches begin
  CellTable cells;                         // from there upwards
};

inline constexpr std::uint32_t kNoNeighbour = std::numeric_limits<std::uint32_t>::max();

/// A cloud in an order of its own, that of a Z-order curve through a grid which follows the cloud's
/// bounds and density, then x, y, z: whatever order the points came in, they lie here in the same
/// one (equal points are interchangeable). On it, exact nearest neighbours. Points must be finite.
class NeighbourGrid {
 public:
  /// `k`: how many neighbours will be asked for; cells are sized for it.
  NeighbourGrid(std::span<const Vec3f> points, int k);

  /// The grid of points 0, rate, 2 rate, ... of this one, in the same order.
  NeighbourGrid every(int rate) const;

  std::size_t size() const { return index_.points.size(); }
  std::span<const Vec3f> points() const { return index_.points; }  // in grid order
  /// order()[i]: where points()[i] was in the input, that of the whole cloud for a grid of every().
  std::span<const std::uint32_t> order() const { return index_.z.order; }

  /// For points begin..end of the grid the k nearest, themselves included: [(end - begin) x k]
  /// grid indices, ascending in each row, kNoNeighbour at its end where size() < k. Of several at
  /// the k-th distance the first in grid order are taken.
  void nearest(int k, std::size_t begin, std::size_t end, std::uint32_t* rows) const;

  /// The grid point nearest to each query; the first in grid order where several are, kNoNeighbour
  /// where the grid is empty. Quickest where consecutive queries are near each other.
  void nearest_to(std::span<const Vec3f> queries, std::uint32_t* found) const;

 private:
  NeighbourGrid() = default;
  void make_cells();

  int k_ = 1;
  CellIndex index_;
};

}  // namespace planescope::planes
