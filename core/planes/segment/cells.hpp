#pragma once

// Cells some levels above the octree's leaves: what "near" means in a cloud. Points are
// in Morton order, so a cell is a range of them.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/disjoint_sets.hpp"
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

// The parts of a plane that do not touch each other.

using Part = std::vector<std::uint32_t>;  // points, ascending Morton positions

/// How many levels above the leaves cells are no smaller than the gap, so that points that touch
/// are in touching cells.
int levels_of_gap(const Cube& cube, double gap_m);

/// Finds the parts of one plane after the other.
class PartFinder {
 public:
  /// `grid`: of cells levels_of_gap() above the leaves.
  PartFinder(const Octree& octree, const CellGrid& grid, int levels, double gap_m);

  /// Points linked by steps of at most gap_m make a part; parts in the order of their first points.
  std::vector<Part> parts_of(std::span<const std::uint32_t> points);

 private:
  /// Points are in Morton order, so that those of a cell, and of a clump in it, are neighbors.
  struct Clump {
    std::uint32_t begin = 0, end = 0;  // so near each other that they touch
  };
  struct Cell {
    std::uint32_t number = 0, begin = 0, end = 0;  // clumps
    bool whole = false;                            // linked among themselves
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
  const int clump_levels_;  // points in one cell of these touch
  std::vector<Clump> clumps_;
  std::vector<Cell> cells_;            // of the plane
  std::vector<std::int32_t> cell_of_;  // per cell of the grid, -1 where the plane has none so far
};

}  // namespace planescope::planes
