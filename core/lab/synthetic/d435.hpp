#pragma once

// A model of the depth errors of the Intel RealSense D435. Depth comes from noisy, quantized
// disparity, so noise and steps grow with the square of depth, and pixels visible to only one
// imager are lost.

#include <cstdint>
#include <limits>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::lab {

/// Focal length 385 px at 640 x 480, scaled with the width; no distortion.
Intrinsics d435_intrinsics(int width, int height);

struct D435Model {
  Intrinsics intrinsics = d435_intrinsics(640, 480);  // of the left imager = of the depth image
  double depth_unit_m = 0.001;                        // meters per count
  double baseline_m = 0.05;                           // the right imager is at +x
  double disparity_sigma_px = 0.08;                   // standard deviation of the matching error
  int correlation_px = 2;                             // smoothing radius of that error
  double disparity_step_px = 1.0 / 32;                // the matcher's sub-pixel steps
  double max_disparity_px = 126;                      // nearer: no measurement
  double max_range_m = 10;                            // farther: no measurement
  double grazing_start_deg = 74;  // angle of incidence at which pixels start to drop out
  double grazing_end_deg = 86;    // ... and at which nearly all do
  // Errors of real cameras that the evaluation sets omit:
  double bow_sigma_px = 0;  // standard deviation of an error correlated over bow_px
  int bow_px = 40;
  // Thresholds in sigma for a smooth field of Gaussian noise:
  double flying_from = kNever;  // at depth jumps, pixels between the two surfaces
  double blind_from = kNever;   // no measurement, as on black, shiny, plain patches
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  bool noise = true;  // false: exact depth, rounded to counts, wherever a ray hits
  bool color = true;  // false: frames without a color image (faster)
};

/// Standard deviation of measured depth at depth z: from z^2 sigma_disparity / (f b) and the
/// matcher's steps.
double depth_sigma_m(const D435Model& model, double z_m);

/// The left imager's exact view, per pixel.
struct TrueView {
  std::vector<double> depth_m;       // 0: nothing
  std::vector<float> cos_incidence;  // between ray and surface normal, 0..1
  std::vector<bool> in_both_eyes;    // also visible to the right imager
};

/// Depth counts measured by the camera; 0 for no measurement.
Image16 measure_depth(const TrueView& view, const D435Model& model, std::uint64_t seed);

/// Exact depth plus independent, nearly Gaussian noise of standard deviation depth_sigma_m() at
/// every pixel; no holes.
Image16 measure_with_pixel_noise(const TrueView& view, const D435Model& model, std::uint64_t seed);

}  // namespace planescope::lab
