#pragma once

// All numbers that steer the segmentation: Sun et al. 2023, Sec. V "Implementation Details", and
// planescope's own refinements (docs/method.md). Defaults stand here and with each
// refinement.

#include <cstdint>
#include <string>

#include "core/planes/classify/classifier.hpp"
#include "core/planes/segment/objective.hpp"
#include "core/planes/segment/refinement.hpp"
#include "core/planes/segment/refinements.hpp"

namespace planescope::planes {

/// Thresholds that follow the noise: how it is measured, theta_rms for Criterion 3, and tau for
/// every "does this point lie on that plane" of the refinements.
struct NoiseOptions {
  bool rms_criterion3 = false;  // Criterion 3: RMS <= theta_rms instead of e_n <= theta_e_n_m2
  bool estimate_sigma = false;  // theta_rms and tau follow the noise; otherwise the fixed ones
  bool sigma_by_range = false;  // noise grows with range squared: both grow with it
  double fixed_rms_m = 0.006;   // theta_rms where the noise is not estimated
  double fixed_tau_m = 0.010;   // tau where the noise is not estimated

  int neighbour_levels = 3;       // neighbouring: in touching cells of 2^this leaves (10 cm)
  int sigma_min_points = 8;       // of a cell, for its residual to mean anything
  double sigma_percentile = 0.8;  // sigma is this percentile of the cells' residuals
  // Stereo noise is correlated over more than a cell: the part that moves a whole cell does not
  // show in its residual. With 1.1 to 1.3 the walls of a real office corner stay whole, with 1 and
  // 1.4 they split. R8's samples hold all of the noise, so that it adds nothing there.
  double sigma_correlated = 1.25;
  double sigma_min_range_m = 0.1;  // by range: nearer cells count as if they were here
  double theta_rms_sigmas = 2;
  double theta_rms_min_m = 0.003;
  double theta_rms_max_m = 0.012;
  double tau_sigmas = 3.5;
  double tau_min_m = 0.008;
  double tau_max_m = 0.020;
  double limits_range_m = 1;        // by range, both upper limits grow with its square from here on
  double other_label_sigmas = 1.5;  // how much nearer a plane of the other label must be to a point
  double normal_sigma_share = 0.5;  // no normal is known better than this much of sigma allows
  double known_growth_per_m = 0;    // by range: the noise as the recording tells it, no option of
                                    // its own; 0: it is measured in the cloud

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("rms_criterion3", "Criterion 3 asks RMS <= theta_rms instead of e_n <= theta_e_n_m2",
              &NoiseOptions::rms_criterion3);
    rows.flag("estimate_sigma", "theta_rms and tau follow the noise measured in the cloud",
              &NoiseOptions::estimate_sigma);
    rows.flag("sigma_by_range", "the noise grows with the square of range, and both with it",
              &NoiseOptions::sigma_by_range);
    rows.number("fixed_rms_m", "m",
                "theta_rms, the largest RMS of a plane, where the noise is not measured",
                &NoiseOptions::fixed_rms_m);
    rows.number("fixed_tau_m", "m", "tau, the distance to a plane, where the noise is not measured",
                &NoiseOptions::fixed_tau_m);
    rows.number("neighbour_levels", "levels",
                "what is near: cells this many levels above the leaves, and those they touch",
                &NoiseOptions::neighbour_levels, {0, 16});
    rows.only_with("estimate_sigma");
    rows.number("sigma_min_points", "points",
                "cells with fewer points of a label are not used to estimate sigma",
                &NoiseOptions::sigma_min_points, {4, 1e9});
    rows.number("sigma_percentile", "share", "sigma is this percentile of the cells' residuals",
                &NoiseOptions::sigma_percentile, {0, 1});
    rows.number("sigma_correlated", "1",
                "by range: sigma times this, for noise that is alike over a whole cell",
                &NoiseOptions::sigma_correlated);
    rows.number("sigma_min_range_m", "m",
                "by range: cells nearer than this count as if they were this far",
                &NoiseOptions::sigma_min_range_m, {0, 1000, true});
    rows.number("theta_rms_sigmas", "sigma", "theta_rms where the noise is measured",
                &NoiseOptions::theta_rms_sigmas);
    rows.number("theta_rms_min_m", "m", "least theta_rms where the noise is measured",
                &NoiseOptions::theta_rms_min_m);
    rows.number("theta_rms_max_m", "m", "greatest theta_rms where the noise is measured",
                &NoiseOptions::theta_rms_max_m);
    rows.number("tau_sigmas", "sigma", "tau where the noise is measured",
                &NoiseOptions::tau_sigmas);
    rows.number("tau_min_m", "m", "least tau where the noise is measured",
                &NoiseOptions::tau_min_m);
    rows.number("tau_max_m", "m", "greatest tau where the noise is measured",
                &NoiseOptions::tau_max_m);
    rows.number("limits_range_m", "m",
                "by range: both greatest values grow with the square of range from here on",
                &NoiseOptions::limits_range_m, {0, 1000, true});
    rows.number("other_label_sigmas", "sigma",
                "a plane of the other label must be nearer to a point by this",
                &NoiseOptions::other_label_sigmas);
    rows.number("normal_sigma_share", "share",
                "no normal is known better than this much of sigma would allow",
                &NoiseOptions::normal_sigma_share);
  }
};

enum class Profile : std::uint8_t { paper, paper_closest, refined };
const char* to_string(Profile profile);
Profile parse_profile(const std::string& text);  // throws Error

enum class MseNormalization : std::uint8_t { scatter, mean };  // e_n as printed, or divided by N
enum class CubeAnchor : std::uint8_t { center, min_corner };   // where the octree's cube stands
enum class MergePartner : std::uint8_t { first, best };
enum class LeftoverRule : std::uint8_t { first, nearest };

struct SegmentOptions {
  Profile profile = Profile::refined;

  // Criteria 1-4.
  int theta_n_out = 5;          // Criterion 1: at most this many outliers
  double theta_r_out = 0.05;    // Criterion 1: at most this share of outliers
  int theta_n_in = 5;           // Criterion 2: at least this many inliers
  double theta_e_n_m2 = 0.005;  // Criterion 3: at most this e_n [m^2]
  MseNormalization mse_normalization = MseNormalization::scatter;
  double theta_coplane = 0.85;  // Criterion 4
  bool criterion4_n2 = true;    // Criterion 4: its third line, with the candidate's own normal
  double merge_offset_m = 0;    // Criterion 4: also |n . dmu| <= this [m]; 0 = not asked
  double leftover_distance_m = 0.005;
  MergePartner merge_partner = MergePartner::first;
  LeftoverRule leftover_rule = LeftoverRule::first;
  bool use_labels = true;      // false: all points carry one label ("without PC") ...
  Label one_label = Label::h;  // ... this one; unknown where nobody knows gravity
  CubeAnchor cube_anchor = CubeAnchor::center;

  NoiseOptions noise;  // thresholds from the measured noise

  ObjectiveOptions objective;  // of depth images; on: nothing but these steers them

  // One member for each file of core/planes/segment/refine/: r1_merge_by_distance and so on.
#define PLANESCOPE_OPTIONS(name) planes::name::Options name;
  PLANESCOPE_REFINEMENTS(PLANESCOPE_OPTIONS)
#undef PLANESCOPE_OPTIONS
};

/// The defaults of a profile.
SegmentOptions profile_options(Profile profile);

/// Is a refinement on that looks at the depth image?
bool needs_pixels(const SegmentOptions& options);

}  // namespace planescope::planes
