#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/planes/classify/cell_table.hpp"
#include "core/planes/classify/neighbour_kernels.hpp"

namespace planescope::planes {

/// A query in units of level-0 cells, moved into the frame's cube if it lies outside.
struct Place {
  Vec3d at;
  ZCell cell;          // at level 0
  double gap_squared;  // by how much it was moved

  Place(const ZFrame& frame, const Vec3f& p);
  ZCell cell_at(int level) const { return {cell[0] >> level, cell[1] >> level, cell[2] >> level}; }
  /// The squared distance within which no point lies outside the 3x3x3 cells around, as the limit
  /// of float distances: those of farther points surely round to more. `cell_m2`: edge squared.
  float limit(int level, double cell_m2) const;
};

/// The candidates around the cells that the last queries of one thread lay in, at every level:
/// queries come along the curve, so that most find theirs here.
class Surroundings {
 public:
  /// `k`: equal points beyond so many may be left out. The index must outlive this.
  Surroundings(const CellIndex& index, std::size_t k) : index_(index), k_(k) {}

  /// The level to begin at: below the usual one where points crowd.
  int first_level(const Place& place);
  /// The points of the 3x3x3 cells around the place's, until the next call.
  Candidates around(const Place& place, int level);
  /// Room for a float for each of them.
  FloatGroup* scratch() { return scratch_.data(); }

 private:
  struct Range {
    std::uint32_t begin, end;
  };
  struct Block {
    ZCell center{-1, -1, -1};
    std::vector<Range> ranges;  // of points, ascending
    std::size_t size = 0;
    bool gathered = false;
    std::size_t groups = 0;
    std::vector<FloatGroup> x, y, z;
    std::vector<IndexGroup> index;
  };

  static void add(Block& block, Range range);
  Block& find(const Place& place, int level);
  void find_ranges(Block& block, int level) const;
  void leave_out_equals(Block& block) const;
  void gather(Block& block);

  const CellIndex& index_;
  std::size_t k_;
  std::array<Block, kZBits + 1> blocks_;
  std::vector<FloatGroup> scratch_;
};

}  // namespace planescope::planes
