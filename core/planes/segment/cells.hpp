#pragma once

// Cells some levels above the octree's leaves: what "near" means in a cloud. Points are
// in Morton order, so a cell is a range of them.

#include <cstdint>
#include <span>
#include <vector>

#include "core/planes/segment/octree.hpp"

namespace planescope::planes {

/// Edge of the cells `levels` above the leaves, at most the cube's [m].
double cell_edge_m(const Octree& octree, int levels);

/// First point of each non-empty cell `levels` above the leaves, and the number of points at the
/// end.
std::vector<std::uint32_t> cell_starts(const Octree& octree, int levels);

/// The non-empty cells and which of them touch (3 x 3 x 3, itself included).
struct CellGrid {
  std::vector<std::uint32_t> starts;           // per cell and one more: ranges of points
  std::vector<std::uint32_t> cell_of;          // per point
  std::vector<std::uint32_t> neighbour_first;  // CSR
  std::vector<std::uint32_t> neighbours;
  std::size_t size() const { return starts.size() - 1; }
};
CellGrid make_cell_grid(const Octree& octree, int levels);

/// For each cell, the planes with points in its 3 x 3 x 3 neighbourhood, ascending.
struct CellPlanes {
  std::vector<std::uint32_t> first;  // CSR
  std::vector<std::int32_t> planes;
  std::span<const std::int32_t> near(std::uint32_t cell) const {
    return {planes.data() + first[cell], planes.data() + first[cell + 1]};
  }
};
/// `plane_of`: per point in Morton order, -1 none. Planes are numbered 0 .. plane_count - 1.
CellPlanes planes_near_cells(const CellGrid& grid,
                             std::span<const std::int32_t> plane_of,
                             std::size_t plane_count);

}  // namespace planescope::planes
