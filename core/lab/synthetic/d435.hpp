#pragma once

// A stereo depth camera after the Intel RealSense D435, as far as its errors matter here: depth
// from disparity, noise and steps that grow with depth squared, what only one eye sees.

#include <cstdint>
#include <limits>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::lab {

/// About 385 px of focal length at 640 x 480; scaled with the width, no distortion.
Intrinsics d435_intrinsics(int width, int height);

struct D435Model {
  Intrinsics intrinsics = d435_intrinsics(640, 480);  // of the left imager = of the depth image
  double depth_unit_m = 0.001;                        // metres per count
  double baseline_m = 0.05;                           // the right imager stands at +x
  double disparity_sigma_px = 0.08;                   // standard deviation of the matching error
  int correlation_px = 2;                             // radius over which that error is smoothed
  double disparity_step_px = 1.0 / 32;                // the matcher's sub-pixel steps
  double max_disparity_px = 126;                      // nearer: no measurement
  double max_range_m = 10;                            // farther: no measurement
  double grazing_start_deg = 74;  // from here on surfaces seen at a slant start to drop out
  double grazing_end_deg = 86;    // and from here on nearly all is lost
  // What real cameras add, and the sets' camera does not:
  double bow_sigma_px = 0;  // standard deviation of an error that is alike over bow_px
  int bow_px = 40;
  // Where a normal noise, alike over patches, is above so many sigma:
  double flying_from = kNever;  // pixels at jumps are measured between the two surfaces
  double blind_from = kNever;   // nothing is measured: black, shiny or without texture
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  bool noise = true;  // false: exact depth, rounded to counts, wherever a ray hits
  bool color = true;  // false: frames without a colour image (quicker)
};

/// Standard deviation of measured depth at depth z: z^2 sigma_disparity / (f b), and the matcher's
/// steps.
double depth_sigma_m(const D435Model& model, double z_m);

/// What the left imager sees, per pixel.
struct TrueView {
  std::vector<double> depth_m;       // 0: nothing
  std::vector<float> cos_incidence;  // between ray and surface normal, 0..1
  std::vector<bool> in_both_eyes;    // the right imager sees it too
};

/// Depth counts as the camera measures them; 0 where it does not.
Image16 measure_depth(const TrueView& view, const D435Model& model, std::uint64_t seed);

/// Every pixel's exact depth with a nearly normal error of depth_sigma_m(), independent of its
/// neighbours'; no holes.
Image16 measure_with_pixel_noise(const TrueView& view, const D435Model& model, std::uint64_t seed);

}  // namespace planescope::lab
