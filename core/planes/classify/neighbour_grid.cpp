// A query looks at the 3x3x3 cells around its own, at the level whose cells hold about the right
// number of points, and one level up for as long as its k-th neighbour could still lie outside.

#include "core/planes/classify/neighbour_grid.hpp"

#include <algorithm>
#include <cassert>

#include "core/planes/classify/surroundings.hpp"

namespace planescope::planes {
namespace {

/// On a surface the k nearest fill a disc; such a share of them in a cell lets 3x3 cells hold it.
double points_per_cell(int k) { return std::max(1.0, k / 3.5); }

double cell_m2(const ZFrame& frame) { return 1 / frame.cells_per_m / frame.cells_per_m; }

}  // namespace

NeighbourGrid::NeighbourGrid(std::span<const Vec3f> points, int k, Simd simd) : k_(k), simd_(simd) {
  assert(std::all_of(points.begin(), points.end(), [](const Vec3f& p) { return p.allFinite(); }));
  index_.z = z_order(points, points_per_cell(k));
  index_.points.reserve(points.size());
  for (const std::uint32_t i : index_.z.order) index_.points.push_back(points[i]);
  make_cells();
}

NeighbourGrid NeighbourGrid::every(int rate) const {
  assert(rate > 0);
  NeighbourGrid coarse;
  coarse.k_ = k_;
  coarse.simd_ = simd_;
  coarse.index_.z.frame = index_.z.frame;
  for (std::size_t i = 0; i < size(); i += static_cast<std::size_t>(rate)) {
    coarse.index_.points.push_back(index_.points[i]);
    coarse.index_.z.codes.push_back(index_.z.codes[i]);
    coarse.index_.z.order.push_back(index_.z.order[i]);
  }
  coarse.make_cells();
  return coarse;
}

void NeighbourGrid::make_cells() {
  for (int axis = 0; axis < 3; ++axis) {
    index_.axes[axis].resize(size() + kGroup);
    for (std::size_t i = 0; i < size(); ++i) index_.axes[axis][i] = index_.points[i][axis];
  }
  index_.crowd = 64 + 16 * static_cast<std::size_t>(k_);
  index_.level = z_level(index_.z.codes, points_per_cell(k_));
  index_.cells = CellTable(index_.z.codes, index_.level);
}

void NeighbourGrid::nearest(int k, std::size_t begin, std::size_t end, std::uint32_t* rows) const {
  assert(k >= 0 && begin <= end && end <= size());
  if (k == 0 || begin == end) return;
  const auto& kernels = neighbour_kernels(simd_);
  const double edge_squared = cell_m2(index_.z.frame);
  const auto width = static_cast<std::size_t>(k), wanted = std::min(width, size());
  Surroundings surroundings(index_, wanted);
  std::vector<std::uint32_t> row(wanted + kGroup);
  for (std::size_t i = begin; i < end; ++i, rows += width) {
    const Vec3f& p = index_.points[i];
    if (i == begin || p != index_.points[i - 1]) {
      const Place place(index_.z.frame, p);
      for (int level = surroundings.first_level(place);; ++level) {
        const Candidates candidates = surroundings.around(place, level);
        if (kernels.nearest(candidates, p.data(), wanted, place.limit(level, edge_squared),
                            surroundings.scratch(), row.data()))
          break;
      }
    }
    std::copy_n(row.begin(), wanted, rows);
    std::fill(rows + wanted, rows + width, kNoNeighbour);
  }
}

void NeighbourGrid::nearest_to(std::span<const Vec3f> queries, std::uint32_t* found) const {
  const auto& kernels = neighbour_kernels(simd_);
  const double edge_squared = cell_m2(index_.z.frame);
  Surroundings surroundings(index_, 1);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    found[i] = kNoNeighbour;
    if (index_.points.empty()) continue;
    const Vec3f& q = queries[i];
    const Place place(index_.z.frame, q);
    for (int level = surroundings.first_level(place);; ++level) {
      const Candidates candidates = surroundings.around(place, level);
      if (candidates.groups > 0 &&
          kernels.nearest_one(candidates, q.data(), &found[i]) <= place.limit(level, edge_squared))
        break;
    }
  }
}

}  // namespace planescope::planes
