#pragma once

// All numbers that steer the segmentation. Sun et al. 2023, Sec. V "Implementation Details", and
// the refinements of planescope's own (docs/method.md). Defaults stand here only.

#include <cstdint>
#include <string>

namespace planescope {

enum class Profile : std::uint8_t { paper, paper_closest, refined };
const char* to_string(Profile profile);
Profile parse_profile(const std::string& text);  // throws Error

enum class MseNormalization : std::uint8_t { scatter, mean };  // e_n as printed, or divided by N
enum class CubeAnchor : std::uint8_t { center, min_corner };   // where the octree's cube stands
enum class MergePartner : std::uint8_t { first, best };
enum class LeftoverRule : std::uint8_t { first, nearest };
/// Which gaps within a plane make two of it: none, those that the sensor looked through, or all.
enum class SplitRule : std::uint8_t { off, seen, on };

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
  bool use_labels = true;  // false: all points carry one label ("without PC")
  CubeAnchor cube_anchor = CubeAnchor::center;

  // Thresholds from the measured noise, for Criterion 3 by RMS and for the refinements.
  bool rms_criterion3 = false;  // Criterion 3: RMS <= theta_rms instead of e_n <= theta_e_n_m2
  bool estimate_sigma = false;  // theta_rms and tau follow the noise; otherwise the fixed ones
  bool sigma_by_range = false;  // noise estimated per range bin: both grow with range
  double fixed_rms_m = 0.006;   // theta_rms where the noise is not estimated
  double fixed_tau_m = 0.010;   // tau where the noise is not estimated

  // Refinements, each on its own.
  bool r1_merge_by_distance = false;
  bool r2_explain_away = false;
  bool r3_weak_candidates = false;
  bool r4_fit_impure_nodes = false;
  bool r5_reassign_shared_cells = false;
  bool r6_refit = false;
  bool r7_second_merge = false;
  bool r8_voxel_spread = false;
  SplitRule split_disconnected = SplitRule::off;
  double split_gap_m = 0.05;  // points no farther apart than this touch
};

/// The defaults of a profile.
SegmentOptions profile_options(Profile profile);

}  // namespace planescope
