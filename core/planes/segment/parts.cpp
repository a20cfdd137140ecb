#include "core/planes/segment/parts.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::planes {

int levels_of_gap(const Cube& cube, double gap_m) {
  const double leaf = cube.edge_m / std::pow(2.0, cube.max_depth);
  return std::clamp(static_cast<int>(std::ceil(std::log2(gap_m / leaf))), 0, cube.max_depth);
}

namespace {

/// Of the largest cells whose diagonal is no longer than the gap; below 0 where leaves are not.
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
    for (std::uint32_t n = grid_.neighbour_first[number]; n < grid_.neighbour_first[number + 1];
         ++n)
      if (const std::int32_t other = cell_of_[grid_.neighbours[n]];
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
  std::uint32_t apart = 0;  // sets among the clumps so far
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

/// Joins two clumps that touch; false where they do not, or were joined before.
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
