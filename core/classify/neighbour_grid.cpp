// A query looks at the 3x3x3 cells around its own, at the level whose cells hold about the right
// number of points, and one level up for as long as its k-th neighbour could still lie outside.

#include "core/classify/neighbour_grid.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/classify/neighbour_kernels.hpp"

namespace planescope {
namespace {

/// On a surface the k nearest fill a disc; such a share of them in a cell lets 3x3 cells hold it.
double points_per_cell(int k) { return std::max(1.0, k / 3.0); }

constexpr std::int32_t kCells = 1 << kZBits;

/// A query in units of level-0 cells, moved into the frame's cube if it lies outside.
struct Place {
  Vec3d at;
  ZCell cell;          // at level 0
  double gap_squared;  // by how much it was moved

  Place(const ZFrame& frame, const Vec3f& p) {
    const Vec3d q = frame.in_cells(p);
    at = q.cwiseMax(0.0).cwiseMin(kCells - 1.0);
    for (int axis = 0; axis < 3; ++axis) cell[axis] = static_cast<std::int32_t>(at[axis]);
    gap_squared = (q - at).squaredNorm();
  }

  ZCell cell_at(int level) const { return {cell[0] >> level, cell[1] >> level, cell[2] >> level}; }

  /// The squared distance in cells within which no point lies outside the 3x3x3 cells around.
  double reach_squared(int level) const {
    const double edge = static_cast<double>(1 << level);
    double reach = 2 * edge;
    for (int axis = 0; axis < 3; ++axis) {
      const double into_cell = at[axis] - static_cast<double>(cell[axis] >> level << level);
      reach = std::min({reach, edge + into_cell, 2 * edge - into_cell});
    }
    return reach * reach + gap_squared;  // points lie in the cube, so the angle there is obtuse
  }
};

/// As the limit of squared float distances: those of farther points surely round to more.
float limit(const ZFrame& frame, const Place& place, int level) {
  if (level == kZBits) return std::numeric_limits<float>::infinity();
  const double squared =
      place.reach_squared(level) / frame.cells_per_m / frame.cells_per_m * (1 - 2e-5);
  constexpr double kUnderflow = 1e-30;  // squares below have fewer digits
  constexpr double kLargest = std::numeric_limits<float>::max();
  return squared > kUnderflow ? static_cast<float>(std::min(squared, kLargest)) : -1.f;
}

}  // namespace

/// The candidates around the cells that the last queries of one thread lay in, at every level:
/// queries come along the curve, so that most find theirs here.
class NeighbourGrid::Surroundings {
 public:
  struct Block {
    ZCell center{-1, -1, -1};
    std::array<CellTable::Range, 27> ranges;
    int range_count = 0;
    std::size_t size = 0;
    bool gathered = false;
    std::vector<CandidateGroup> groups;
  };

  Surroundings(const NeighbourGrid& grid, std::size_t k) : grid_(grid), k_(k) {}

  /// The level to begin at: below the usual one where points crowd.
  int first_level(const Place& place) {
    const std::size_t crowd = 64 + 16 * k_;
    int level = grid_.level_;
    while (level > 0 && find(place, level).size > crowd) --level;
    return level;
  }

  const Block& around(const Place& place, int level) {
    Block& block = find(place, level);
    if (!block.gathered) gather(block);
    return block;
  }

  std::vector<DistanceGroup> distances;

 private:
  Block& find(const Place& place, int level) {
    Block& block = blocks_[level];
    const ZCell center = place.cell_at(level);
    if (block.center == center) return block;
    block.center = center;
    block.gathered = false;
    block.range_count = 0;
    block.size = 0;
    std::array<std::array<std::uint64_t, 3>, 3> spread;  // by axis and neighbour
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < 3; ++i) spread[axis][i] = z_spread(center[axis] + i - 1) << axis;
    const std::int32_t cells = kCells >> level;
    const auto inside = [&](int axis, int i) {
      return center[axis] + i - 1 >= 0 && center[axis] + i - 1 < cells;
    };
    for (int z = 0; z < 3; ++z) {
      if (!inside(2, z)) continue;
      for (int y = 0; y < 3; ++y) {
        if (!inside(1, y)) continue;
        for (int x = 0; x < 3; ++x)
          if (inside(0, x)) add(block, spread[0][x] | spread[1][y] | spread[2][z], level);
      }
    }
    return block;
  }

  void add(Block& block, std::uint64_t code, int level) {
    const CellTable::Range range = grid_.cells_.find(grid_.z_.codes, code, level);
    if (range.begin == range.end) return;
    int at = block.range_count++;
    for (; at > 0 && block.ranges[at - 1].begin > range.begin; --at)
      block.ranges[at] = block.ranges[at - 1];
    block.ranges[at] = range;
    block.size += range.end - range.begin;
  }

  void gather(Block& block) {
    block.gathered = true;
    block.groups.resize((block.size + kGroup - 1) / kGroup);
    const std::vector<Vec3f>& points = grid_.points_;
    const bool crowded = block.size > 64 + 16 * k_;
    std::size_t n = 0;
    for (int r = 0; r < block.range_count; ++r)
      for (std::uint32_t i = block.ranges[r].begin; i < block.ranges[r].end; ++i) {
        // Of equal points, which lie in a run, only the first k can be anybody's neighbours.
        if (crowded && i >= k_ && points[i] == points[i - k_]) continue;
        CandidateGroup& group = block.groups[n / kGroup];
        const std::size_t lane = n++ % kGroup;
        group.x[lane] = points[i].x();
        group.y[lane] = points[i].y();
        group.z[lane] = points[i].z();
        group.index[lane] = i;
      }
    block.groups.resize((n + kGroup - 1) / kGroup);
    for (; n % kGroup != 0; ++n) {
      CandidateGroup& group = block.groups[n / kGroup];
      group.x[n % kGroup] = std::numeric_limits<float>::quiet_NaN();
      group.y[n % kGroup] = group.z[n % kGroup] = 0;
      group.index[n % kGroup] = kNoNeighbour;
    }
    if (distances.size() < block.groups.size()) distances.resize(block.groups.size());
  }

  const NeighbourGrid& grid_;
  std::size_t k_;
  std::array<Block, kZBits + 1> blocks_;
};

NeighbourGrid::NeighbourGrid(std::span<const Vec3f> points, int k, Simd simd)
    : k_(k), simd_(simd), z_(z_order(points, points_per_cell(k))) {
  assert(std::all_of(points.begin(), points.end(), [](const Vec3f& p) { return p.allFinite(); }));
  points_.reserve(points.size());
  for (const std::uint32_t i : z_.order) points_.push_back(points[i]);
  make_cells();
}

NeighbourGrid NeighbourGrid::every(int rate) const {
  assert(rate > 0);
  NeighbourGrid coarse;
  coarse.k_ = k_;
  coarse.simd_ = simd_;
  coarse.z_.frame = z_.frame;
  for (std::size_t i = 0; i < size(); i += static_cast<std::size_t>(rate)) {
    coarse.points_.push_back(points_[i]);
    coarse.z_.codes.push_back(z_.codes[i]);
    coarse.z_.order.push_back(z_.order[i]);
  }
  coarse.make_cells();
  return coarse;
}

void NeighbourGrid::make_cells() {
  level_ = z_level(z_.codes, points_per_cell(k_));
  cells_ = CellTable(z_.codes, level_);
}

void NeighbourGrid::nearest(int k, std::size_t begin, std::size_t end, std::uint32_t* rows) const {
  assert(k >= 0 && begin <= end && end <= size());
  if (k == 0 || begin == end) return;
  const auto& kernels = neighbour_kernels(simd_);
  const auto width = static_cast<std::size_t>(k), wanted = std::min(width, size());
  Surroundings surroundings(*this, wanted);
  std::vector<std::uint32_t> row(wanted + kGroup);
  for (std::size_t i = begin; i < end; ++i, rows += width) {
    const Vec3f& p = points_[i];
    if (i == begin || p != points_[i - 1]) {
      const Place place(z_.frame, p);
      for (int level = surroundings.first_level(place);; ++level) {
        const auto& groups = surroundings.around(place, level).groups;
        if (kernels.nearest(groups.data(), groups.size(), p.data(), wanted,
                            limit(z_.frame, place, level), surroundings.distances.data(),
                            row.data()))
          break;
      }
    }
    std::copy_n(row.begin(), wanted, rows);
    std::fill(rows + wanted, rows + width, kNoNeighbour);
  }
}

void NeighbourGrid::nearest_to(std::span<const Vec3f> queries, std::uint32_t* found) const {
  const auto& kernels = neighbour_kernels(simd_);
  Surroundings surroundings(*this, 1);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    found[i] = kNoNeighbour;
    if (points_.empty()) continue;
    const Vec3f& q = queries[i];
    const Place place(z_.frame, q);
    for (int level = surroundings.first_level(place);; ++level) {
      const auto& groups = surroundings.around(place, level).groups;
      if (!groups.empty() && kernels.nearest_one(groups.data(), groups.size(), q.data(),
                                                 &found[i]) <= limit(z_.frame, place, level))
        break;
    }
  }
}

}  // namespace planescope
