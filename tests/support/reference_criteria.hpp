#pragma once

// What core/planes/segment/criteria and core/planes/segment/noise say, once more and with the
// numbers written out (docs/method.md, "refined"): nothing here calls them.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/planes/segment/segment.hpp"

namespace planescope::reference {

/// A set of points as a plane, and what the criteria ask of it.
struct Surface {
  PlaneFit fit;
  Mat3d scatter = Mat3d::Zero();  // of the points and, with R8, of their measurements [m^2]
  std::array<std::pair<double, double>, 3> extent = {};  // lowest and highest point, per axis [m]
  double sigma_ang = 0;                                  // of the normal [rad]
  double tau = 0;                                        // at the centroid [m]
};

struct Noise {
  bool known = false, by_range = false, of_spreads = false;
  double factor = 0;  // sigma [m], by range that at 1 m
  double fixed_rms = 0, fixed_tau = 0;

  double sigma(double range) const { return known ? factor * (by_range ? range * range : 1) : 0; }
  double within(double least, double value, double most, double range) const {
    if (by_range && range > 1) most *= range * range;
    return std::min(std::max(value, least), most);
  }
  double theta_rms(double range) const {
    return known ? within(0.003, (of_spreads ? 1.4 : 2) * sigma(range), 0.012, range) : fixed_rms;
  }
  double tau(double range) const {
    return known ? within(0.008, (of_spreads ? 2.5 : 3.5) * sigma(range), 0.020, range) : fixed_tau;
  }
  /// The 80th percentile; samples are ranges and residuals.
  void measure(const std::vector<std::pair<double, double>>& samples) {
    std::vector<double> sorted;
    for (const auto& [range, sigma] : samples)
      sorted.push_back(by_range ? sigma * (of_spreads ? 1 : 1.25) / std::max(0.01, range * range)
                                : sigma);
    std::sort(sorted.begin(), sorted.end());
    known = !sorted.empty();
    const double last = static_cast<double>(sorted.size()) - 1;
    if (known) factor = sorted[static_cast<std::size_t>(0.8 * last)];
  }
};

/// Residual variance over the variance along the second axis; never better than sigma / 2 allows.
inline double normal_sigma(const PlaneFit& f, double sigma) {
  if (f.eigenvalues[1] <= 0) return M_PI / 2;
  const double residual = f.count > 4 ? f.eigenvalues[0] / (f.count - 3) : f.eigenvalues[0];
  return std::min(M_PI / 2, std::sqrt(std::max(residual, sigma * sigma / 4) / f.eigenvalues[1]));
}

/// Of a rectangle of these variances: side^2 / 12 each [m^2].
inline double area_of_a_point(const PlaneFit& f) {
  const double a = std::sqrt(12 * f.eigenvalues[1] / f.count);
  const double b = std::sqrt(12 * f.eigenvalues[2] / f.count);
  return a * b / f.count;
}

/// Criterion 4 of a list's plane and a candidate: their offset [m], if they are coplanar.
inline std::optional<double> offset_of_coplanar(const PlaneFit& plane,
                                                const PlaneFit& candidate,
                                                const planes::SegmentOptions& o) {
  const Vec3d dmu = plane.centroid - candidate.centroid;
  const double offset = std::abs(plane.normal.dot(dmu));
  const double most = 1 - o.theta_coplane;
  if (std::abs(plane.normal.dot(candidate.normal)) < o.theta_coplane) return {};
  if (dmu.norm() > 0 && offset / dmu.norm() > most) return {};
  if (o.criterion4_n2 && dmu.norm() > 0 && std::abs(candidate.normal.dot(dmu)) / dmu.norm() > most)
    return {};
  if (o.merge_offset_m > 0 && offset > o.merge_offset_m) return {};
  return offset;
}

/// R1: what merging would cost, if the one that is less sure lies on the other, `plane` where both
/// are alike. R3 does not ask for the angle.
inline std::optional<double> cost_of_merging(const Surface& plane,
                                             const Surface& candidate,
                                             bool any_angle = false) {
  const bool turned = candidate.sigma_ang < plane.sigma_ang;
  const Surface& sure = turned ? candidate : plane;
  const Surface& other = turned ? plane : candidate;
  const Vec3d n = sure.fit.normal;

  double gap2 = 0;  // between the boxes
  for (int axis = 0; axis < 3; ++axis) {
    const double apart = std::max(sure.extent[axis].first - other.extent[axis].second,
                                  other.extent[axis].first - sure.extent[axis].second);
    if (apart > 0) gap2 += apart * apart;
  }
  const double gap = std::sqrt(gap2);
  if (gap > 0.1 && gap * 3 * other.sigma_ang > other.tau) return {};

  const double degrees = 180 / M_PI * std::acos(std::min(1.0, std::abs(n.dot(other.fit.normal))));
  const double most = gap > 0.1 ? 5 : 10 + 3 * 180 / M_PI * other.sigma_ang;
  if (!any_angle && degrees > most) return {};

  const Vec3d between = other.fit.centroid - sure.fit.centroid;
  const double offset = std::abs(n.dot(between));
  const double lever = std::min(0.5, (between - n.dot(between) * n).norm());
  const double bound2 = std::pow(other.tau, 2) + std::pow(3 * sure.sigma_ang * lever, 2);
  const double spread2 = n.dot(other.scatter * n) / other.fit.count;
  if (offset * offset > bound2 || spread2 > bound2) return {};
  return (offset * offset + spread2) / bound2;
}

// ---- Sight ----

// Where rays passed through a plane, as SplitRule::seen asks: the plane's cells that rays went
// through, in a set.

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
