#pragma once

// How noisy the points are, and the thresholds that follow: theta_rms for Criterion 3 and tau for
// every "does this point lie on that plane" of the refinements.

#include <algorithm>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/segment/octree.hpp"
#include "core/planes/segment/options.hpp"

namespace planescope::planes {

/// Standard deviation of the measurements across a surface: the same everywhere, or growing with
/// the square of the distance to the sensor, as stereo depth does.
struct NoiseModel {
  NoiseOptions options;
  r8_voxel_spread::Options of_spread_options;  // instead of the former, where of_spreads
  bool estimated = false;                      // false: the fixed thresholds hold
  bool by_range = false;    // sigma(r) = growth r^2, and the limits of the thresholds grow alike
  bool of_spreads = false;  // R8: sigma is that of single measurements, not of voxels' means
  double constant_m = 0;    // [m]
  double growth_per_m = 0;  // [m per m^2]

  double sigma(double range) const {  // [m]; 0 where not estimated
    if (!estimated) return 0;
    return by_range ? growth_per_m * range * range : constant_m;
  }
  double theta_rms(double range) const;  // [m]
  double tau(double range) const {       // [m]
    if (!estimated) return options.fixed_tau_m;
    const double sigmas = of_spreads ? of_spread_options.tau_sigmas : options.tau_sigmas;
    return limited(sigmas * sigma(range), options.tau_min_m, options.tau_max_m, range);
  }
  /// By how much nearer a plane of the other label must be, for a point to go to it [m].
  double other_label_penalty(double range) const {
    return options.other_label_sigmas * sigma(range);
  }

 private:
  double limited(double value, double least, double greatest, double range) const {
    const double ratio = range / options.limits_range_m;
    if (by_range) greatest *= std::max(1.0, ratio * ratio);
    return std::min(std::max(value, least), std::max(least, greatest));
  }
};

/// One cell's residual noise and where it is.
struct NoiseSample {
  double range_m = 0;
  double sigma_m = 0;
};
/// The model's constant is a percentile of the samples' sigma; its growth that of sigma / r^2.
void fit_noise(NoiseModel& model, std::vector<NoiseSample> samples, bool by_range);

/// Samples are sqrt(lambda0 / (n - 3)) of the points of one label, where labels are used, in each
/// cell of `neighbour_levels`, sigma_min_points at least.
NoiseModel measure_noise(const Octree& octree, const Vec3d& sensor, const SegmentOptions& options);

}  // namespace planescope::planes
