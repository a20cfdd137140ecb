#pragma once

// Cells some levels above the octree's leaves, for neighborhood queries in a cloud. Points are in
// Morton order, so each cell is a range of points.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/disjoint_sets.hpp"
#include "core/planes/segment/octree.hpp"

namespace planescope::planes {

/// Edge of the cells `levels` above the leaves, limited to the cube's edge [m].
double cell_edge_m(const Octree& octree, int levels);

/// First point of each non-empty cell `levels` above the leaves, followed by the number of points.
std::vector<std::uint32_t> cell_starts(const Octree& octree, int levels);

/// Non-empty cells and their neighbors (3 x 3 x 3, including the cell itself).
struct CellGrid {
  std::vector<std::uint32_t> starts;          // ranges of points; size() + 1 entries
  std::vector<std::uint32_t> cell_of;         // per point
  std::vector<std::uint32_t> neighbor_first;  // CSR
  std::vector<std::uint32_t> neighbors;
  std::size_t size() const { return starts.size() - 1; }
};
CellGrid make_cell_grid(const Octree& octree, int levels);

/// For each cell, the planes with points in its 3 x 3 x 3 neighborhood, ascending.
struct CellPlanes {
  std::vector<std::uint32_t> first;  // CSR
  std::vector<std::int32_t> planes;
  std::span<const std::int32_t> near(std::uint32_t cell) const {
    return {planes.data() + first[cell], planes.data() + first[cell + 1]};
  }
};
/// `plane_of`: per point in Morton order, -1 none. Plane indices are 0 .. plane_count - 1.
CellPlanes planes_near_cells(const CellGrid& grid,
                             std::span<const std::int32_t> plane_of,
                             std::size_t plane_count);

// Connected parts of a plane.

using Part = std::vector<std::uint32_t>;  // points, ascending Morton positions

/// Number of levels above the leaves at which cells are at least as large as the gap, so that
/// touching points are in neighboring cells.
int levels_of_gap(const Cube& cube, double gap_m);

/// Finds the parts of planes, one plane at a time.
class PartFinder {
 public:
  /// `grid`: cells levels_of_gap() above the leaves.
  PartFinder(const Octree& octree, const CellGrid& grid, int levels, double gap_m);

  /// Groups points connected by steps of at most gap_m. Parts are ordered by their first point.
  std::vector<Part> parts_of(std::span<const std::uint32_t> points);

 private:
  /// Points are in Morton order, so the points of a cell, and of a clump in it, are contiguous.
  struct Clump {
    std::uint32_t begin = 0, end = 0;  // points close enough to touch
  };
  struct Cell {
    std::uint32_t number = 0, begin = 0, end = 0;  // clumps
    bool whole = false;                            // all clumps are connected
  };

  void gather(std::span<const std::uint32_t> points);
  void link_within(std::span<const std::uint32_t> points, Cell& cell, DisjointSets& sets) const;
  void link(std::span<const std::uint32_t> points,
            const Cell& a,
            const Cell& b,
            DisjointSets& sets) const;
  bool join(std::span<const std::uint32_t> points,
            std::uint32_t i,
            std::uint32_t j,
            DisjointSets& sets) const;
  bool touch(std::span<const std::uint32_t> points, const Clump& a, const Clump& b) const;
  std::vector<Part> parts_in(std::span<const std::uint32_t> points, DisjointSets& sets) const;

  const Octree& octree_;
  const CellGrid& grid_;
  const double gap_m_;
  const int clump_levels_;  // points in one cell at this level touch
  std::vector<Clump> clumps_;
  std::vector<Cell> cells_;            // of the current plane
  std::vector<std::int32_t> cell_of_;  // per cell of the grid; -1 if the plane has none there yet
};

}  // namespace planescope::planes
