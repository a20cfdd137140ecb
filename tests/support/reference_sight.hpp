#pragma once

// Where rays passed through a plane, as SplitRule::seen asks (docs/method.md): the plane's cells
// that rays went through, in a set.

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/planes/segment/segment.hpp"

namespace planescope::reference {

/// Where a look from `eye` at `seen` goes through the plane, if that lies between them.
inline std::optional<Vec3d> crossing(const PlaneFit& plane, const Vec3d& eye, const Vec3d& seen) {
  const double before = plane.distance_m(eye), behind = plane.distance_m(seen);
  if (before == 0 || behind == 0 || (before > 0) == (behind > 0)) return {};
  const double share = std::abs(before) / (std::abs(before) + std::abs(behind));
  return (1 - share) * eye + share * seen;
}

/// Cells of 2 cm, of a sparse cloud as wide as its points are apart, over the bounds of a plane's
/// points; no more than 1000 along an axis.
class PassedCells {
 public:
  PassedCells(const PlaneFit& plane, const std::vector<Vec3d>& points, double spacing)
      : u_(plane.normal.unitOrthogonal()), v_(plane.normal.cross(u_)) {
    std::set<double> us, vs;
    for (const Vec3d& p : points) us.insert(u_.dot(p)), vs.insert(v_.dot(p));
    low_u_ = *us.begin(), low_v_ = *vs.begin();
    const double high_u = *us.rbegin(), high_v = *vs.rbegin();
    edge_ = std::max({0.02, spacing, (high_u - low_u_) / 1000, (high_v - low_v_) / 1000});
    last_ = cell_of(high_u, high_v);
  }
  double edge() const { return edge_; }

  void add(const Vec3d& p) {
    const Cell cell = cell_of(u_.dot(p), v_.dot(p));
    const auto [column, row] = cell;
    if (column >= 0 && row >= 0 && column <= last_.first && row <= last_.second)
      cells_.insert(cell);
  }
  /// Rays are about a cell apart: in the cell of p or one of the eight around it?
  bool any_at(const Vec3d& p) const {
    const auto [column, row] = cell_of(u_.dot(p), v_.dot(p));
    for (int k = 0; k < 9; ++k)
      if (cells_.count({column + k % 3 - 1, row + k / 3 - 1}) > 0) return true;
    return false;
  }

 private:
  using Cell = std::pair<int, int>;
  Cell cell_of(double u, double v) const {
    return {static_cast<int>(std::floor((u - low_u_) / edge_)),
            static_cast<int>(std::floor((v - low_v_) / edge_))};
  }

  Vec3d u_, v_;
  double low_u_ = 0, low_v_ = 0, edge_ = 0;
  Cell last_;
  std::set<Cell> cells_;
};

}  // namespace planescope::reference
