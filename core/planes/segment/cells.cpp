// Neighboring cells of the octree's leaves, and connected parts of planes.

#include "core/planes/segment/cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/model/morton.hpp"
#include "core/planes/cloud/key_numbers.hpp"

namespace planescope::planes {

double cell_edge_m(const Octree& octree, int levels) {
  const int depth = octree.cube.max_depth - std::min(levels, octree.cube.max_depth);
  return octree.cube.edge_m / static_cast<double>(1u << depth);
}

std::vector<std::uint32_t> cell_starts(const Octree& octree, int levels) {
  const int shift = 3 * std::min(levels, octree.cube.max_depth);
  std::vector<std::uint32_t> starts;
  for (std::size_t i = 0; i < octree.keys.size(); ++i)
    if (i == 0 || octree.keys[i] >> shift != octree.keys[i - 1] >> shift)
      starts.push_back(static_cast<std::uint32_t>(i));
  starts.push_back(static_cast<std::uint32_t>(octree.keys.size()));
  return starts;
}

namespace {

/// Maps cells to indices: with an array over their bounding box if it is not much larger than their
/// number, otherwise with a hash.
class CellIndex {
 public:
  using Place = std::array<std::int32_t, 3>;

  explicit CellIndex(const std::vector<Place>& cells) : hashed_(0) {
    constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
    low_ = {kMost, kMost, kMost};
    Place high{0, 0, 0};
    for (const Place& cell : cells)
      for (int axis = 0; axis < 3; ++axis) {
        low_[axis] = std::min(low_[axis], cell[axis]);
        high[axis] = std::max(high[axis], cell[axis]);
      }
    double volume = 1;
    for (int axis = 0; axis < 3; ++axis) {  // with an empty margin
      --low_[axis];
      size_[axis] = cells.empty() ? 0 : high[axis] - low_[axis] + 2;
      volume *= size_[axis];
    }
    if (volume <= 4096 + 64 * static_cast<double>(cells.size()))
      dense_.assign(static_cast<std::size_t>(volume), KeyNumbers::kNone);
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
      if (dense_.empty())
        hashed_.find_or_add(at(cells[c]));
      else
        dense_[at(cells[c])] = c;
    }
  }
  /// Index of a cell in or next to the bounding box; KeyNumbers::kNone if empty.
  std::uint32_t find(const Place& cell) const {
    return dense_.empty() ? hashed_.find(at(cell)) : dense_[at(cell)];
  }

 private:
  /// Index into an array over the box; three edges of 21 bits plus the margin fit.
  std::uint64_t at(const Place& cell) const {
    return (static_cast<std::uint64_t>(cell[2] - low_[2]) * size_[1] + (cell[1] - low_[1])) *
               size_[0] +
           (cell[0] - low_[0]);
  }
  Place low_{}, size_{};
  std::vector<std::uint32_t> dense_;
  KeyNumbers hashed_;
};

}  // namespace

CellGrid make_cell_grid(const Octree& octree, int levels) {
  const int shift = 3 * std::min(levels, octree.cube.max_depth);
  CellGrid grid;
  grid.starts = cell_starts(octree, levels);
  grid.cell_of.resize(octree.keys.size());
  std::vector<CellIndex::Place> cells;
  cells.reserve(grid.size());
  for (std::uint32_t c = 0; c < grid.size(); ++c) {
    const auto cell = morton_cell(octree.keys[grid.starts[c]] >> shift);
    cells.push_back({static_cast<std::int32_t>(cell[0]), static_cast<std::int32_t>(cell[1]),
                     static_cast<std::int32_t>(cell[2])});
    std::fill(grid.cell_of.begin() + grid.starts[c], grid.cell_of.begin() + grid.starts[c + 1], c);
  }
  const CellIndex index(cells);
  grid.neighbor_first.reserve(grid.size() + 1);
  grid.neighbors.reserve(grid.size() * 12);
  grid.neighbor_first.push_back(0);
  for (const auto& [x, y, z] : cells) {
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (const std::uint32_t found = index.find({x + dx, y + dy, z + dz});
              found != KeyNumbers::kNone)
            grid.neighbors.push_back(found);
    grid.neighbor_first.push_back(static_cast<std::uint32_t>(grid.neighbors.size()));
  }
  return grid;
}

CellPlanes planes_near_cells(const CellGrid& grid,
                             std::span<const std::int32_t> plane_of,
                             std::size_t plane_count) {
  // First the planes with points in each cell, then the union over its neighbors.
  std::vector<std::uint32_t> seen(plane_count, 0);
  std::uint32_t stamp = 0;
  const auto collect = [&](std::vector<std::int32_t>& into, std::int32_t plane) {
    if (plane < 0 || seen[plane] == stamp) return;
    seen[plane] = stamp;
    into.push_back(plane);
  };
  constexpr std::int32_t kNone = -1, kSeveral = -2;
  std::vector<std::int32_t> only;  // per cell: its only plane
  std::vector<std::uint32_t> own_first{0};
  std::vector<std::int32_t> own;
  for (std::size_t c = 0; c < grid.size(); ++c) {
    ++stamp;
    std::int32_t last = -1;  // mostly equal to the previous point's plane
    for (std::uint32_t i = grid.starts[c]; i < grid.starts[c + 1]; ++i)
      if (plane_of[i] != last) collect(own, last = plane_of[i]);
    const std::size_t count = own.size() - own_first.back();
    only.push_back(count == 0 ? kNone : count == 1 ? own.back() : kSeveral);
    own_first.push_back(static_cast<std::uint32_t>(own.size()));
  }
  CellPlanes result;
  result.first.push_back(0);
  for (std::size_t c = 0; c < grid.size(); ++c) {
    ++stamp;
    std::int32_t last = kNone;  // most neighbors have the previous plane, or none
    for (std::uint32_t k = grid.neighbor_first[c]; k < grid.neighbor_first[c + 1]; ++k) {
      const std::uint32_t n = grid.neighbors[k];
      if (only[n] == last || only[n] == kNone) continue;
      if (only[n] != kSeveral) {
        collect(result.planes, last = only[n]);
        continue;
      }
      for (std::uint32_t j = own_first[n]; j < own_first[n + 1]; ++j)
        collect(result.planes, own[j]);
    }
    std::sort(result.planes.begin() + result.first.back(), result.planes.end());
    result.first.push_back(static_cast<std::uint32_t>(result.planes.size()));
  }
  return result;
}

// ---- Parts of a plane ----

int levels_of_gap(const Cube& cube, double gap_m) {
  const double leaf = cube.edge_m / std::pow(2.0, cube.max_depth);
  return std::clamp(static_cast<int>(std::ceil(std::log2(gap_m / leaf))), 0, cube.max_depth);
}

namespace {

/// Level of the largest cells whose diagonal is at most the gap; negative if leaves are larger.
int levels_of_clumps(const Octree& octree, int levels, double gap_m) {
  while (levels >= 0 && std::sqrt(3.0) * cell_edge_m(octree, levels) > gap_m) --levels;
  return levels;
}

}  // namespace

PartFinder::PartFinder(const Octree& octree, const CellGrid& grid, int levels, double gap_m)
    : octree_(octree),
      grid_(grid),
      gap_m_(gap_m),
      clump_levels_(levels_of_clumps(octree, levels, gap_m)),
      cell_of_(grid.size(), -1) {}

std::vector<Part> PartFinder::parts_of(std::span<const std::uint32_t> points) {
  gather(points);
  DisjointSets sets(clumps_.size());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    link_within(points, cells_[c], sets);
    cell_of_[cells_[c].number] = static_cast<std::int32_t>(c);
    const std::uint32_t number = cells_[c].number;
    for (std::uint32_t n = grid_.neighbor_first[number]; n < grid_.neighbor_first[number + 1]; ++n)
      if (const std::int32_t other = cell_of_[grid_.neighbors[n]];
          other >= 0 && other < static_cast<std::int32_t>(c))
        link(points, cells_[c], cells_[other], sets);
  }
  for (const Cell& cell : cells_) cell_of_[cell.number] = -1;
  return parts_in(points, sets);
}

void PartFinder::gather(std::span<const std::uint32_t> points) {
  const int shift = 3 * clump_levels_;
  cells_.clear();
  clumps_.clear();
  std::uint64_t clump = 0;
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    const std::uint32_t number = grid_.cell_of[points[k]];
    const auto at = static_cast<std::uint32_t>(clumps_.size());
    const bool new_cell = cells_.empty() || cells_.back().number != number;
    if (new_cell) cells_.push_back({number, at, at});
    const std::uint64_t now = shift >= 0 ? octree_.keys[points[k]] >> shift : k;
    if (new_cell || now != clump) {
      clumps_.push_back({k, k});
      ++cells_.back().end;
      clump = now;
    }
    clumps_.back().end = k + 1;
  }
}

void PartFinder::link_within(std::span<const std::uint32_t> points,
                             Cell& cell,
                             DisjointSets& sets) const {
  std::uint32_t apart = 0;  // number of separate sets so far
  for (std::uint32_t i = cell.begin; i < cell.end; ++i) {
    ++apart;
    for (std::uint32_t j = i; j-- > cell.begin && apart > 1;)
      if (join(points, i, j, sets)) --apart;
  }
  cell.whole = apart == 1;
}

void PartFinder::link(std::span<const std::uint32_t> points,
                      const Cell& a,
                      const Cell& b,
                      DisjointSets& sets) const {
  const bool both_whole = a.whole && b.whole;
  if (both_whole && sets.root(a.begin) == sets.root(b.begin)) return;
  for (std::uint32_t i = a.begin; i < a.end; ++i)
    for (std::uint32_t j = b.begin; j < b.end; ++j)
      if (join(points, i, j, sets) && both_whole) return;
}

/// Joins two clumps that touch; returns false if they do not, or were already joined.
bool PartFinder::join(std::span<const std::uint32_t> points,
                      std::uint32_t i,
                      std::uint32_t j,
                      DisjointSets& sets) const {
  if (sets.root(i) == sets.root(j) || !touch(points, clumps_[i], clumps_[j])) return false;
  sets.join(i, j);
  return true;
}

bool PartFinder::touch(std::span<const std::uint32_t> points,
                       const Clump& a,
                       const Clump& b) const {
  for (std::uint32_t i = a.begin; i < a.end; ++i)
    for (std::uint32_t j = b.begin; j < b.end; ++j)
      if ((octree_.points[points[i]] - octree_.points[points[j]]).norm() <= gap_m_) return true;
  return false;
}

std::vector<Part> PartFinder::parts_in(std::span<const std::uint32_t> points,
                                       DisjointSets& sets) const {
  std::vector<Part> parts;
  std::vector<std::uint32_t> number(clumps_.size());
  for (std::uint32_t c = 0; c < clumps_.size(); ++c) {
    const std::uint32_t root = sets.root(c);
    if (root == c) {
      number[c] = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
    }
    Part& part = parts[number[root]];
    part.insert(part.end(), points.begin() + clumps_[c].begin, points.begin() + clumps_[c].end);
  }
  return parts;
}

}  // namespace planescope::planes
