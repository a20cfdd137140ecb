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
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = SegmentOptions;
    rows.group.images = false;  // the objective asks Criteria 1 and 2 of clouds
    rows.number("theta_n_out", "Most outliers", "points", "Criterion 1: most outliers of a node", &O::theta_n_out).symbol = "θ_Nout";
    rows.number("theta_r_out", "Largest outlier share", "share", "Criterion 1: largest share of outliers in a node", &O::theta_r_out, {0, 1}).symbol = "θ_rout";
    rows.number("theta_n_in", "Fewest inliers", "points", "Criterion 2: fewest inliers of a node", &O::theta_n_in, {3, 1e9}).symbol = "θ_Nin";
    rows.group.images = {};
    rows.group.objective = false;
    rows.number("theta_e_n_m2", "Largest fit error", "m2", "Criterion 3: largest error e_n of the inliers' plane fit", &O::theta_e_n_m2).symbol = "θ_en";
    rows.choice("mse_normalization", "Fit error is over", {"scatter", "mean"}, "e_n is the smallest eigenvalue of the scatter as printed, or divided by N", &O::mse_normalization);
    rows.number("theta_coplane", "Least coplanarity", "1", "Criterion 4: smallest coplanarity of two merged candidates", &O::theta_coplane, {0, 1}).symbol = "θ_coplane";
    rows.flag("criterion4_n2", "Ask for the third line", "Criterion 4: also evaluate its third line, with the candidate's normal", &O::criterion4_n2);
    rows.number("merge_offset_m", "Largest merge offset", "m", "Criterion 4: largest |n . dmu|; 0 disables the test", &O::merge_offset_m);
    rows.choice("merge_partner", "Merge partner", {"first", "best"}, "Coplanar plane that a candidate is merged into", &O::merge_partner);
    rows.number("leftover_distance_m", "Assignment distance", "m", "Largest distance at which an unassigned point is assigned to a plane", &O::leftover_distance_m);
    rows.group.images = false;
    rows.group.objective = {};
    rows.flag("use_labels", "Use labels", "Off: all points have one label, the paper's \"w/o PC\"", &O::use_labels);
    rows.choice("cube_anchor", "Cube anchor", {"center", "min_corner"}, "Cube centered by the cloud stage, or starting at the minimum corner of the points", &O::cube_anchor);
  }
};

/// The defaults of a profile.
SegmentOptions profile_options(Profile profile);

}  // namespace planescope::planes
