#pragma once

// How noisy the points are, and the thresholds that follow: theta_rms for Criterion 3 and tau for
// every "does this point lie on that plane" of the refinements.

#include <vector>

#include "core/geometry/types.hpp"
#include "core/segment/octree.hpp"
#include "core/segment/options.hpp"

namespace planescope {

/// Standard deviation of the measurements across a surface: the same everywhere, or growing with
/// the square of the distance to the sensor, as stereo depth does.
struct NoiseModel {
  bool estimated = false;  // false: the fixed thresholds hold
  bool by_range =
      false;  // true: sigma(r) = growth r^2, and the limits of the thresholds grow alike
  bool of_spreads = false;  // R8: sigma is that of single measurements, not of voxels' means
  double constant_m = 0;    // [m]
  double growth_per_m = 0;  // [m per m^2]
  double fixed_rms_m = 0.006;
  double fixed_tau_m = 0.010;

  double sigma(double range) const;      // [m]; 0 where not estimated
  double theta_rms(double range) const;  // 2 sigma (of spreads: 1.4) in 3 .. 12 mm [m]
  double tau(double range) const;        // 3 sigma (of spreads: 2.5) in 8 .. 20 mm [m]
  /// By how much nearer a plane of the other label must be, for a point to go to it: 1.5 sigma [m].
  double other_label_penalty(double range) const { return 1.5 * sigma(range); }
};

/// One cell's residual noise and where it is.
struct NoiseSample {
  double range_m = 0;
  double sigma_m = 0;
};
/// The model's constant is the 80th percentile of the samples' sigma; its growth that of sigma /
/// r^2.
void fit_noise(NoiseModel& model, std::vector<NoiseSample> samples, bool by_range);

/// Samples are sqrt(lambda0 / (n - 3)) of the points of one label, where labels are used, in each
/// 10 cm cell, 8 at least.
NoiseModel measure_noise(const Octree& octree, const Vec3d& sensor, const SegmentOptions& options);

}  // namespace planescope
