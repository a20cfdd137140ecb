#include "core/planes/segment/cells.hpp"

#include <algorithm>

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

CellGrid make_cell_grid(const Octree& octree, int levels) {
  const int up = std::min(levels, octree.cube.max_depth);
  const int shift = 3 * up;
  const std::int64_t cells_per_edge = std::int64_t{1} << (octree.cube.max_depth - up);
  CellGrid grid;
  grid.starts = cell_starts(octree, levels);
  grid.cell_of.resize(octree.keys.size());
  KeyNumbers cells(grid.size());  // codes differ, so that each cell gets its own number
  for (std::uint32_t c = 0; c < grid.size(); ++c) {
    cells.find_or_add(octree.keys[grid.starts[c]] >> shift);
    std::fill(grid.cell_of.begin() + grid.starts[c], grid.cell_of.begin() + grid.starts[c + 1], c);
  }
  grid.neighbour_first.reserve(grid.size() + 1);
  grid.neighbours.reserve(grid.size() * 12);
  grid.neighbour_first.push_back(0);
  for (std::uint32_t c = 0; c < grid.size(); ++c) {
    const auto cell = morton_cell(octree.keys[grid.starts[c]] >> shift);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const std::int64_t x = cell[0] + dx, y = cell[1] + dy, z = cell[2] + dz;
          if (std::min({x, y, z}) < 0 || std::max({x, y, z}) >= cells_per_edge) continue;
          const std::uint32_t found =
              cells.find(morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                     static_cast<std::uint32_t>(z)));
          if (found != KeyNumbers::kNone) grid.neighbours.push_back(found);
        }
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
  std::vector<std::uint32_t> own_first{0};
  std::vector<std::int32_t> own;
  for (std::size_t c = 0; c < grid.size(); ++c) {
    ++stamp;
    for (std::uint32_t i = grid.starts[c]; i < grid.starts[c + 1]; ++i) collect(own, plane_of[i]);
    own_first.push_back(static_cast<std::uint32_t>(own.size()));
  }
  CellPlanes result;
  result.first.push_back(0);
  for (std::size_t c = 0; c < grid.size(); ++c) {
    ++stamp;
    for (std::uint32_t k = grid.neighbour_first[c]; k < grid.neighbour_first[c + 1]; ++k) {
      const std::uint32_t n = grid.neighbours[k];
      for (std::uint32_t j = own_first[n]; j < own_first[n + 1]; ++j)
        collect(result.planes, own[j]);
    }
    std::sort(result.planes.begin() + result.first.back(), result.planes.end());
    result.first.push_back(static_cast<std::uint32_t>(result.planes.size()));
  }
  return result;
}

}  // namespace planescope::planes
