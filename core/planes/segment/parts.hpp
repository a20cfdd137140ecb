#pragma once

// The parts of a plane that do not touch each other.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/disjoint_sets.hpp"
#include "core/planes/segment/cells.hpp"

namespace planescope::planes {

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
