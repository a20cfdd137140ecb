#pragma once

// All numbers that steer the segmentation: Sun et al. 2023, Sec. V "Implementation Details", and
// planescope's own refinements (docs/method.md). Defaults stand here, in noise_options.hpp and with
// each refinement.

#include <cstdint>
#include <string>

#include "core/planes/classify/classifier.hpp"
#include "core/planes/segment/noise_options.hpp"
#include "core/planes/segment/refinements.hpp"

namespace planescope::planes {

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
