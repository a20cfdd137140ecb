#include "core/planes/segment/cells.hpp"

#include <algorithm>
#include <bit>

#include "core/model/morton.hpp"

namespace planescope::planes {
namespace {

/// Cell number by Morton code: open addressing, linear probing.
class CellTable {
 public:
  explicit CellTable(std::size_t cells)
      : mask_(std::bit_ceil(std::max<std::size_t>(16, 2 * cells)) - 1),
        codes_(mask_ + 1),
        values_(mask_ + 1, -1) {}

  void insert(std::uint64_t code, std::int32_t value) {
    std::size_t i = slot(code);
    while (values_[i] >= 0) i = (i + 1) & mask_;
    codes_[i] = code;
    values_[i] = value;
  }
  std::int32_t find(std::uint64_t code) const {
    for (std::size_t i = slot(code); values_[i] >= 0; i = (i + 1) & mask_)
      if (codes_[i] == code) return values_[i];
    return -1;
  }

 private:
  std::size_t slot(std::uint64_t code) const {
    return static_cast<std::size_t>((code * 0x9e3779b97f4a7c15ULL) >> 20) & mask_;
  }
  std::size_t mask_;
  std::vector<std::uint64_t> codes_;
  std::vector<std::int32_t> values_;
};

}  // namespace

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
  CellTable table(grid.size());
  for (std::uint32_t c = 0; c < grid.size(); ++c) {
    table.insert(octree.keys[grid.starts[c]] >> shift, static_cast<std::int32_t>(c));
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
          const std::int32_t found =
              table.find(morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                     static_cast<std::uint32_t>(z)));
          if (found >= 0) grid.neighbours.push_back(static_cast<std::uint32_t>(found));
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
