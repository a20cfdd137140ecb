#pragma once

// How noisy the points are, as `refined` measured it, for what judges distances to planes
// afterwards.

namespace planescope::planes {

/// Standard deviation of the measurements across a surface: the same everywhere, or growing with
/// the square of the distance to the sensor, as stereo depth does.
struct NoiseModel {
  bool estimated = false;   // false: the profiles of the paper do not measure it
  bool by_range = false;    // sigma(r) = growth r^2
  double constant_m = 0;    // [m]
  double growth_per_m = 0;  // [m per m^2]
  double reach_sigma = 3;   // a point this far off a plane may be on it

  double sigma(double range) const {  // [m]; 0 where not estimated
    if (!estimated) return 0;
    return by_range ? growth_per_m * range * range : constant_m;
  }
  /// How far off a plane its points may lie [m].
  double tau(double range) const {
    constexpr double kUnmeasured_m = 0.01;
    return estimated ? reach_sigma * sigma(range) : kUnmeasured_m;
  }
};

}  // namespace planescope::planes
