#pragma once

// How noisy a depth image is, measured in the image itself at two scales: white noise, which
// differs from pixel to pixel, and the bow, the sensor's low-frequency error (none in a scanner,
// about a centimeter at 1 to 3 m in a D400).

#include <vector>

#include "core/planes/depth/inverse_depth.hpp"
#include "core/planes/segment/objective.hpp"

namespace planescope::planes {

struct DepthNoise {
  double white = 0;  // standard deviation of rho [1/m]; 0: too little depth to measure it
  double bow = 0;    // likewise, over distances of length_px and more
  double wide = 0;   // of single pixels about planes of wide squares: white noise and bow [1/m]
  double length_px = 20;  // over which the bow develops
  double lateral_px = 2;  // sideways error of a pixel

  /// Variance of a pixel about a plane, and of the bow [1/m^2]. A sideways error counts by the
  /// slope of rho: on a grazing surface it is most of the noise.
  double white2(const InversePlane& p) const { return white * white + sideways2(p); }
  double bow2(const InversePlane& p) const { return bow * bow + sideways2(p); }
  double sideways2(const InversePlane& p) const {
    return lateral_px * lateral_px * (p.a * p.a + p.b * p.b);
  }
  double pixel2(const InversePlane& p) const { return white2(p) + bow2(p); }
  /// Share of the bow's variance that shows between two places this far apart.
  double developed(double distance2_px2) const {
    return std::min(1.0, distance2_px2 / (length_px * length_px));
  }

  /// What joining two sets of pixels adds to the misfit: the mean squared offset between their
  /// planes over the variance that noise and bow explain. The cost of a plane, options.merge_cost,
  /// is what joining them saves.
  double join_cost(const PixelMoments& a,
                   const InversePlane& plane_a,
                   const PixelMoments& b,
                   const InversePlane& plane_b) const {
    PixelMoments both = a;
    both += b;
    // No plane is credited with less misfit than noise makes: a cell's face cuts noise in two
    // layers, each flatter than it.
    const double apart = std::max(plane_a.sse, (a.n - 3) * white * white) +
                         std::max(plane_b.sse, (b.n - 3) * white * white);
    const double offset2 = std::max(0.0, both.fit().sse - apart) * both.n / (a.n * b.n);
    const double du = a.u / a.n - b.u / b.n, dv = a.v / a.n - b.v / b.n;
    const double explained = 3 * (white2(plane_a) / a.n + white2(plane_b) / b.n) +
                             std::min(bow2(plane_a), bow2(plane_b)) * developed(du * du + dv * dv);
    return offset2 / explained;
  }
};

/// `blocks`: moments of all full squares of 4 px, row by row, `columns` to a row. `unit_m`: what
/// depth is rounded to, 0: nothing.
DepthNoise measure_depth_noise(const std::vector<PixelMoments>& blocks,
                               int columns,
                               int width_px,
                               double unit_m,
                               const ObjectiveOptions& options);

}  // namespace planescope::planes
