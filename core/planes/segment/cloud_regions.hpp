#pragma once

// Finds planes of a cloud by one objective: misfit relative to the measured noise, a cost per
// plane, and a cost per unexplained point. The octree's case IV nodes are the initial regions;
// every later change of a region or point is decided by its change of the objective. The scales
// (noise, bow and point spacing) are measured in patches of the cloud.

#include "core/planes/segment/state.hpp"

namespace planescope::planes {

/// Characteristic polynomial x^3 - a x^2 + b x - c of the points' scatter. Its smallest root is the
/// sum of squared distances to the least-squares plane [m^2].
struct Cubic {
  double a = 0, b = 0, c = 0;

  explicit Cubic(const Moments& moments) {
    const Mat3d s = moments.scatter();
    const double xy2 = s(0, 1) * s(0, 1), xz2 = s(0, 2) * s(0, 2), yz2 = s(1, 2) * s(1, 2);
    a = s(0, 0) + s(1, 1) + s(2, 2);
    b = s(0, 0) * s(1, 1) + s(0, 0) * s(2, 2) + s(1, 1) * s(2, 2) - xy2 - xz2 - yz2;
    c = s(0, 0) * s(1, 1) * s(2, 2) + 2 * s(0, 1) * s(0, 2) * s(1, 2) - s(0, 0) * yz2 -
        s(1, 1) * xz2 - s(2, 2) * xy2;
  }
  double at(double x) const { return ((x - a) * x + b) * x - c; }
  double slope_at(double x) const { return (3 * x - 2 * a) * x + b; }
  /// Fast sufficient test: the smallest root may exceed x even if this returns false.
  bool least_root_is_beyond(double x) const { return at(x) < 0 && slope_at(x) > 0 && 3 * x < a; }
  /// Newton's method, which ascends from 0 to the root.
  double least_root() const {
    double x = 0;
    for (int i = 0; i < 40; ++i) {
      const double slope = slope_at(x);
      if (slope <= 0) break;
      const double step = -at(x) / slope;
      x += step;
      if (step <= 1e-9 * x + 1e-16 * a) break;
    }
    return std::max(0.0, x);
  }
  /// Product of the other two roots, if the smallest root is small [m^4].
  double product_of_others() const { return std::max(0.0, b); }
};

struct CloudScales {
  double white_m = 0;     // standard deviation of points about their surface
  double measured_m = 0;  // white_m before its lower bound, options.resolution, is applied
  double bow_m = 0;       // standard deviation of the error common to a region's points
  double spacing_m = 0;   // distance between neighboring points on a surface
  double variance_m2() const { return white_m * white_m + bow_m * bow_m; }
};
CloudScales measure_scales(const SegmentState& state, const ObjectiveOptions& options);

/// Noise model for Criterion 3 and for point-to-plane distances after the segmentation.
NoiseModel noise_of(const CloudScales& scales, const ObjectiveOptions& options);

/// Turns the traversal's planes (one per case IV node) and leftovers into the final planes.
void find_cloud_regions(SegmentState& state,
                        const CloudScales& scales,
                        const ObjectiveOptions& options);

}  // namespace planescope::planes
