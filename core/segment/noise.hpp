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

/// One cell's residual noise and where it is.
struct NoiseSample {
  double range_m = 0;
  double sigma_m = 0;
};
/// Knots from samples: the 80th percentile overall, or in bins of 25 cm of range.
void fit_noise(NoiseModel& model, std::vector<NoiseSample> samples, bool by_range);

/// Samples are sqrt(lambda0 / (n - 3)) of the points of one label in each 10 cm cell, 8 at least.
NoiseModel measure_noise(const Octree& octree, const Vec3d& sensor, const SegmentOptions& options);

}  // namespace planescope
