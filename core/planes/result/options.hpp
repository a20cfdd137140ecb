#pragma once

// Options for analyzing planes: footholds, steppable planes and stairs. A wheel is a foot as long
// as its contact with the ground; a gripper is a foot as wide as its pads.

namespace planescope::planes {

struct FootOptions {
  double radius_m = 0;         // radius of the foot or its bounding circle, so that any yaw is
                               // allowed; 0: no foot
  double margin_m = 0.01;      // extra distance from the outline, which is accurate to 1 cm
  double unknown_share = 0.1;  // of the foot's circle: smaller unmeasured holes are ignored
  double max_off_m = 0.01;     // largest distance of a foothold's surface from the plane
  // Limits of a steppable plane.
  double max_slope_deg = 25;
  double min_area_m2 = 0.0025;  // area for the center of the foot
  double max_rough_m = 0.010;   // RMS height
  double min_support = 0.6;     // share of the outline's pixels that were measured

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.number("foot_radius_m", "Foot radius", "m",
                "Radius of the foot, or of the circle around it (--foot); 0 disables footholds",
                &FootOptions::radius_m, {0, 10});
    rows.number("foot_margin_m", "Foot margin", "m",
                "Extra distance of the foot from borders and holes", &FootOptions::margin_m,
                {0, 10});
    rows.number("foot_unknown_share", "Maximum unmeasured holes", "share",
                "Unmeasured holes up to this share of the foot's circle are ignored",
                &FootOptions::unknown_share);
    rows.number("foot_max_off_m", "Maximum deviation", "m",
                "Maximum distance of a foothold's surface from the plane", &FootOptions::max_off_m);
    rows.number("foot_max_slope_deg", "Maximum slope", "deg", "Steppable planes: maximum slope",
                &FootOptions::max_slope_deg, {0, 90});
    rows.number("foot_min_area_m2", "Minimum area", "m2",
                "Steppable planes: minimum area for the center of the foot",
                &FootOptions::min_area_m2);
    rows.number("foot_max_rough_m", "Maximum roughness", "m",
                "Steppable planes: maximum RMS of their height", &FootOptions::max_rough_m);
    rows.number("foot_min_support", "Minimum support", "share",
                "Steppable planes: minimum measured share of the outline",
                &FootOptions::min_support, {0, 1});
  }
};

/// Limits for steps and for flights of steps.
struct StairsOptions {
  double rise_min_m = 0.03, rise_max_m = 0.30;    // of a step
  double going_min_m = 0.15, going_max_m = 0.50;  // from nosing to nosing
  double width_min_m = 0.2;                       // visible width of a nosing
  double rise_spread_m = 0.03;   // largest difference between the rises of successive steps
  double going_spread_m = 0.06;  // same for goings
  double turn_deg = 12;          // nosings of one flight are parallel within this
  double gap_m = 0.08;           // between a level and the nosing behind it, excluding the
                                 // hidden part
  double level_deg = 5;          // a plane tilted more and higher than a step is a ramp
  double landing_goings = 1.5;   // a last level deeper than this many goings is a landing
  double kerb_width_m = 0.6;     // a single step at least this wide is a kerb
  double kerb_depth_m = 0.4;     // ... if both levels are at least this deep
  double floor_m2 = 0.1;         // smallest area of the floor

  template <typename Rows>
  static void describe(Rows& rows) {
    using O = StairsOptions;
    rows.number("stairs_rise_min_m", "Minimum rise", "m", "Minimum rise of a step", &O::rise_min_m,
                {0.005, 1});
    rows.number("stairs_rise_max_m", "Maximum rise", "m", "Maximum rise of a step", &O::rise_max_m,
                {0.005, 2});
    rows.number("stairs_going_min_m", "Minimum going", "m", "Minimum going, from nosing to nosing",
                &O::going_min_m, {0.01, 5});
    rows.number("stairs_going_max_m", "Maximum going", "m", "Maximum going, from nosing to nosing",
                &O::going_max_m, {0.01, 5});
    rows.number("stairs_width_min_m", "Minimum width", "m", "Minimum visible width of a nosing",
                &O::width_min_m, {0.02, 10});
    rows.number("stairs_rise_spread_m", "Rise variation", "m",
                "Maximum difference in rise between neighboring steps", &O::rise_spread_m, {0, 1});
    rows.number("stairs_going_spread_m", "Going variation", "m",
                "Maximum difference in going between neighboring steps", &O::going_spread_m,
                {0, 1});
    rows.number("stairs_turn_deg", "Nosing angle", "deg",
                "Maximum angle between the nosings of a flight", &O::turn_deg, {0, 45});
    rows.number("stairs_gap_m", "Maximum gap", "m",
                "Maximum gap between a level and the nosing behind it, beyond the part hidden by "
                "the upper one",
                &O::gap_m, {0, 1});
    rows.number(
        "stairs_level_deg", "Minimum ramp tilt", "deg",
        "Minimum tilt of a ramp; its height must also change by more than stairs_rise_min_m",
        &O::level_deg, {0, 45});
    rows.number("stairs_landing_goings", "Minimum landing depth", "goings",
                "Minimum depth of a landing, in goings of its flight", &O::landing_goings,
                {1, 100});
    rows.number("stairs_kerb_width_m", "Minimum kerb width", "m",
                "Minimum width of a kerb, a single step", &O::kerb_width_m, {0, 100});
    rows.number("stairs_kerb_depth_m", "Minimum depth at a kerb", "m",
                "Minimum depth of the levels before and behind a kerb", &O::kerb_depth_m, {0, 100});
    rows.number("stairs_floor_m2", "Minimum floor area", "m2",
                "Minimum area of the floor, the lowest level", &O::floor_m2, {0, 100});
  }
};

}  // namespace planescope::planes
