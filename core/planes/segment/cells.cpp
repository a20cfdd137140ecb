#include "core/planes/segment/cells.hpp"

#include <algorithm>
#include <array>
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

/// Cells by their place: in an array over the box around them where that is not much larger than
/// they are many, in a hash elsewhere.
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
    for (int axis = 0; axis < 3; ++axis) {  // with a margin, where nothing is
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
  /// Of a cell, or of one beside it; KeyNumbers::kNone where it is empty.
  std::uint32_t find(const Place& cell) const {
    return dense_.empty() ? hashed_.find(at(cell)) : dense_[at(cell)];
  }

 private:
  /// In an array over the box: three edges of 21 bits and a little fit.
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
  grid.neighbour_first.reserve(grid.size() + 1);
  grid.neighbours.reserve(grid.size() * 12);
  grid.neighbour_first.push_back(0);
  for (const auto& [x, y, z] : cells) {
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (const std::uint32_t found = index.find({x + dx, y + dy, z + dz});
              found != KeyNumbers::kNone)
            grid.neighbours.push_back(found);
    grid.neighbour_first.push_back(static_cast<std::uint32_t>(grid.neighbours.size()));
  }
  return grid;
}

CellPlanes planes_near_cells(const CellGrid& grid,
                             std::span<const std::int32_t> plane_of,
                             std::size_t plane_count) {
  // Planes with points in each cell itself, then the union over its neighbours.
  std::vector<std::uint32_t> seen(plane_count, 0);
  std::uint32_t stamp = 0;
  const auto collect = [&](std::vector<std::int32_t>& into, std::int32_t plane) {
    if (plane < 0 || seen[plane] == stamp) return;
    seen[plane] = stamp;
    into.push_back(plane);
  };
  constexpr std::int32_t kNone = -1, kSeveral = -2;
  std::vector<std::int32_t> only;  // per cell, its plane where it has one
  std::vector<std::uint32_t> own_first{0};
  std::vector<std::int32_t> own;
  for (std::size_t c = 0; c < grid.size(); ++c) {
    ++stamp;
    std::int32_t last = -1;  // mostly that of the point before
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
    std::int32_t last = kNone;  // most neighbors have the plane of the one before, or none
    for (std::uint32_t k = grid.neighbour_first[c]; k < grid.neighbour_first[c + 1]; ++k) {
      const std::uint32_t n = grid.neighbours[k];
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

}  // namespace planescope::planes
