#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/model/parallel.hpp"
#include "core/model/types.hpp"
#include "core/planes/classify/cell_table.hpp"

namespace planescope::planes {

inline constexpr std::uint32_t kNoNeighbour = std::numeric_limits<std::uint32_t>::max();

/// A cloud in an order of its own, that of a Z-order curve through a grid which follows the cloud's
/// bounds and density, then x, y, z: whatever order the points came in, they lie here in the same
/// one (equal points are interchangeable). On it, exact nearest neighbours. Points must be finite.
class NeighbourGrid {
 public:
  /// `k`: how many neighbours will be asked for; cells are sized for it.
  NeighbourGrid(std::span<const Vec3f> points, int k, Simd simd = best_simd());

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
  Simd simd_ = Simd::plain;
  CellIndex index_;
};

}  // namespace planescope::planes
