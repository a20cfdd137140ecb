#pragma once

// All parameters of the segmentation: Sun et al. 2023, Sec. V "Implementation Details", and
// planescope's own objective. None of the latter depends on the camera or is a length;
// sensor-dependent quantities are measured in each frame.

#include <cstdint>
#include <string>

#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

/// Noise of the points as measured by `refined`, for evaluating point-to-plane distances after the
/// segmentation: the standard deviation across a surface, either constant or, for stereo depth,
/// growing with the squared distance to the sensor.
struct NoiseModel {
  bool estimated = false;   // false: the paper's profiles do not measure it
  bool by_range = false;    // sigma(r) = growth r^2
  double constant_m = 0;    // [m]
  double growth_per_m = 0;  // [m per m^2]
  double reach_sigma = 3;   // points within this many sigma may be on the plane

  double sigma(double range) const {  // [m]; 0 if not estimated
    if (!estimated) return 0;
    return by_range ? growth_per_m * range * range : constant_m;
  }
  /// Largest distance of a plane's points from it [m].
  double tau(double range) const {
    constexpr double kUnmeasured_m = 0.01;
    return estimated ? reach_sigma * sigma(range) : kUnmeasured_m;
  }
};

/// The objective of `refined`: misfit relative to the measured noise, a cost per plane, and a cost
/// per unexplained pixel or point.
struct ObjectiveOptions {
  // Depth images (core/planes/depth) and clouds (cloud_regions.hpp).
  double flat = 3;         // Criterion 3: largest variance of a cell, relative to the expected
  double bow = 2.5;        // low-frequency error, relative to the measured one
  double merge_cost = 10;  // cost of a plane: regions join if their misfit costs less

  // Depth images.
  double two_planes = 0.3;    // Criterion 1: halves of a cell are separate planes above this share
                              // of merge_cost
  double filled = 0.4;        // Criterion 2: smallest share of a cell's pixels in the cell
  double lateral_px = 2;      // lateral error of a pixel
  double reach_sigma = 3;     // cost of an unexplained pixel, as a residual
  double hidden_share = 0.5;  // parts separated by an occlusion join below this share of merge_cost
  double worth_px = 1000;     // smallest worth of a listed plane
  double undecided = 0.5;     // planes with a smaller margin are undecided

  // Clouds; sigma is the noise measured in the cloud.
  double resolution = 0.05;        // lower limit of sigma, in point spacings
  double point_reach_sigma = 4.5;  // cost of an unexplained point, as a distance
  double label_sigma = 2;          // extra distance of a plane with the other label
  double plane_cost = 180;         // cost of a plane, in squared sigma

  template <typename Rows>
  static void describe(Rows& rows) {
    using O = ObjectiveOptions;
    rows.number("flat", "Cell flatness", "1",
                "Criterion 3: maximum variance of a cell, relative to the expected variance",
                &O::flat, {0, 1e6, true});
    rows.number("bow", "Maximum bow", "1",
                "Low-frequency depth error, relative to the measured one", &O::bow, {0, 100});
    rows.number("merge_cost", "Merge cost", "1",
                "Cost of a plane: regions merge when their misfit costs less", &O::merge_cost,
                {0, 1e6});
    rows.group.images = true;
    rows.number("two_planes", "Two-plane split", "share",
                "Depth images, Criterion 1: maximum cost of one plane instead of two, as a share "
                "of merge_cost",
                &O::two_planes, {0, 1e6});
    rows.number("filled", "Minimum filled share", "share",
                "Depth images, Criterion 2: minimum share of a cell's pixels on its plane",
                &O::filled, {0, 1});
    rows.number("lateral_px", "Lateral error", "px", "Depth images: lateral error of a pixel",
                &O::lateral_px, {0, 100});
    rows.number("reach_sigma", "Unexplained pixel cost", "sigma",
                "Depth images: cost of an unassigned pixel, as a residual", &O::reach_sigma,
                {0, 100});
    rows.number("hidden_share", "Hidden part cost", "share",
                "Depth images: cost limit for merging parts separated by an occlusion, as a share "
                "of merge_cost",
                &O::hidden_share, {0, 100});
    rows.number("worth_px", "Minimum plane worth", "px",
                "Depth images: minimum worth of a plane, in pixels of a plane with 1 % RMS (image "
                "640 px wide)",
                &O::worth_px, {0, 1e9});
    rows.number("undecided", "Undecided margin", "1",
                "Depth images: planes with a smaller margin are undecided", &O::undecided,
                {0, 1e6});
    rows.group.images = false;
    rows.number("resolution", "Spacing noise", "spacings",
                "Clouds: minimum noise sigma, in point spacings", &O::resolution, {0, 100});
    rows.number("point_reach_sigma", "Unexplained point cost", "sigma",
                "Clouds: cost of an unassigned point, as a distance", &O::point_reach_sigma,
                {0, 1000});
    rows.number("label_sigma", "Label penalty", "sigma",
                "Clouds: extra distance of a point from a plane with the other label",
                &O::label_sigma, {0, 1000});
    rows.number("plane_cost", "Plane cost", "sigma2", "Clouds: cost of a plane", &O::plane_cost,
                {0, 1e9});
  }
};

enum class Profile : std::uint8_t { paper, paper_closest, refined };
const char* to_string(Profile profile);
Profile parse_profile(const std::string& text);  // throws Error

enum class MseNormalization : std::uint8_t { scatter, mean };  // e_n as printed, or divided by N
enum class CubeAnchor : std::uint8_t { center, min_corner };   // position of the octree's cube
enum class MergePartner : std::uint8_t { first, best };

struct SegmentOptions {
  Profile profile = Profile::refined;

  // Criteria 1-4. With the objective, clouds use Criteria 1 and 2 only.
  int theta_n_out = 5;          // Criterion 1: at most this many outliers
  double theta_r_out = 0.05;    // Criterion 1: at most this share of outliers
  int theta_n_in = 5;           // Criterion 2: at least this many inliers
  double theta_e_n_m2 = 0.005;  // Criterion 3: at most this e_n [m^2]
  MseNormalization mse_normalization = MseNormalization::scatter;
  double theta_coplane = 0.85;  // Criterion 4
  bool criterion4_n2 = true;    // Criterion 4: third line, with the candidate's own normal
  double merge_offset_m = 0;    // Criterion 4: also |n . dmu| <= this [m]; 0: disabled
  double leftover_distance_m = 0.005;
  MergePartner merge_partner = MergePartner::first;
  bool use_labels = true;      // false: all points have one label ("without PC") ...
  Label one_label = Label::h;  // ... this one; unknown if gravity is unknown
  CubeAnchor cube_anchor = CubeAnchor::center;

  ObjectiveOptions objective;  // of `refined`

  /// Whether planes are found by the objective, not by the paper's method.
  bool by_objective() const { return profile == Profile::refined; }
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = SegmentOptions;
    rows.group.images = false;  // the objective uses Criteria 1 and 2 for clouds
    rows.number("theta_n_out", "Maximum outliers", "points",
                "Criterion 1: maximum number of outliers in a node", &O::theta_n_out)
        .symbol = "θ_Nout";
    rows.number("theta_r_out", "Maximum outlier share", "share",
                "Criterion 1: maximum share of outliers in a node", &O::theta_r_out, {0, 1})
        .symbol = "θ_rout";
    rows.number("theta_n_in", "Minimum inliers", "points",
                "Criterion 2: minimum number of inliers in a node", &O::theta_n_in, {3, 1e9})
        .symbol = "θ_Nin";
    rows.group.images = {};
    rows.group.objective = false;
    rows.number("theta_e_n_m2", "Maximum fit error", "m2",
                "Criterion 3: maximum error e_n of the inliers' plane fit", &O::theta_e_n_m2)
        .symbol = "θ_en";
    rows.choice(
        "mse_normalization", "Fit error normalization", {"scatter", "mean"},
        "e_n is the smallest eigenvalue of the scatter matrix, as in the paper, or divided by N",
        &O::mse_normalization);
    rows.number("theta_coplane", "Minimum coplanarity", "1",
                "Criterion 4: minimum coplanarity of two merged candidates", &O::theta_coplane,
                {0, 1})
        .symbol = "θ_coplane";
    rows.flag("criterion4_n2", "Third line of Criterion 4",
              "Criterion 4: also evaluate its third line, with the candidate's normal",
              &O::criterion4_n2);
    rows.number("merge_offset_m", "Maximum merge offset", "m",
                "Criterion 4: maximum |n . dmu|; 0 disables the test", &O::merge_offset_m);
    rows.choice("merge_partner", "Merge partner", {"first", "best"},
                "Coplanar plane that a candidate is merged into", &O::merge_partner);
    rows.number("leftover_distance_m", "Assignment distance", "m",
                "Maximum distance at which an unassigned point is assigned to a plane",
                &O::leftover_distance_m);
    rows.group.images = false;
    rows.group.objective = {};
    rows.flag("use_labels", "Use labels",
              "Use h and v labels; off: one label for all points, the paper's \"w/o PC\"",
              &O::use_labels);
    rows.choice("cube_anchor", "Cube anchor", {"center", "min_corner"},
                "Cube centered by the cloud stage, or starting at the minimum corner of the points",
                &O::cube_anchor);
  }
};

/// The defaults of a profile.
SegmentOptions profile_options(Profile profile);

}  // namespace planescope::planes
