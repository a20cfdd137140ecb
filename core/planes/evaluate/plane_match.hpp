#pragma once

// Which found plane stands for which true one.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::planes {

/// Points shared by each true and each found plane. Row 0 / column 0: in no plane.
struct TruthOverlap {
  int truth = 0, found = 0;  // largest ids
  std::vector<std::uint64_t> shared;
  std::vector<std::uint64_t> truth_size, found_size;

  std::uint64_t at(int t, int f) const {
    return shared[static_cast<std::size_t>(t) * (found + 1) + f];
  }
  double iou(int t, int f) const;
};

/// Ids: > 0 a plane, 0 none; truth < 0 is not counted. Planes up to the ids given have their places
/// even where they have no points.
TruthOverlap count_truth_overlap(std::span<const std::int32_t> truth,
                                 std::span<const std::int32_t> found,
                                 int last_truth = 0,
                                 int last_found = 0);

/// One to one, with the greatest sum of IoU: by true id - 1 the found id, 0 where it has none.
std::vector<int> found_of_truth(const TruthOverlap& overlap);

/// Hungarian method (Kuhn-Munkres with potentials, O(n^3)): the assignment of rows to columns with
/// the greatest total of `value` (row-major, rows x columns, values >= 0). Per row its column, -1
/// where the row got none or a pair of value 0.
std::vector<int> best_assignment(const std::vector<double>& value, int rows, int columns);

/// Between the unit normals of two planes, whichever way they look: 0 to 90 degrees.
double plane_angle_deg(const Vec3d& a, const Vec3d& b);

}  // namespace planescope::planes
