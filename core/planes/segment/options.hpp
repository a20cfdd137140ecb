#pragma once

// All numbers that steer the segmentation: Sun et al. 2023, Sec. V "Implementation Details", and
// those of planescope's own objective.

#include <cstdint>
#include <string>

#include "core/planes/classify/classifier.hpp"
#include "core/planes/segment/objective.hpp"

namespace planescope::planes {

enum class Profile : std::uint8_t { paper, paper_closest, refined };
const char* to_string(Profile profile);
Profile parse_profile(const std::string& text);  // throws Error

enum class MseNormalization : std::uint8_t { scatter, mean };  // e_n as printed, or divided by N
enum class CubeAnchor : std::uint8_t { center, min_corner };   // where the octree's cube stands
enum class MergePartner : std::uint8_t { first, best };

struct SegmentOptions {
  Profile profile = Profile::refined;

  // Criteria 1-4. The objective asks Criteria 1 and 2 of clouds.
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
  bool use_labels = true;      // false: all points carry one label ("without PC") ...
  Label one_label = Label::h;  // ... this one; unknown where nobody knows gravity
  CubeAnchor cube_anchor = CubeAnchor::center;

  ObjectiveOptions objective;  // of `refined`

  /// Whether planes are found by the objective; otherwise as the paper says.
  bool by_objective() const { return profile == Profile::refined; }
};

/// The defaults of a profile.
SegmentOptions profile_options(Profile profile);

}  // namespace planescope::planes
