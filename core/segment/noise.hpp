#pragma once

// How noisy the points are, and the thresholds that follow: theta_rms for Criterion 3 and tau for
// every "does this point lie on that plane" of the refinements.

#include <vector>

#include "core/geometry/types.hpp"
#include "core/segment/octree.hpp"
#include "core/segment/options.hpp"

namespace planescope {

/// Standard deviation of the measurements across a surface, piecewise linear in the distance to the
/// sensor. One knot: the same everywhere.
struct NoiseModel {
  std::vector<double> range_m;  // ascending knots
  std::vector<double> sigma_m;  // at each knot; both empty: noise was not estimated
  double fixed_rms_m = 0.006;
  double fixed_tau_m = 0.010;

  double sigma(double range) const;      // 0 where not estimated
  double theta_rms(double range) const;  // [m]
  double tau(double range) const;        // [m]
};

/// The 80th percentile of sqrt(lambda0 / (n - 3)) over 10 cm cells with at least 8 points of one
/// label, overall or (options.sigma_by_range) in bins of range.
NoiseModel measure_noise(const Octree& octree, const Vec3d& sensor, const SegmentOptions& options);

}  // namespace planescope
