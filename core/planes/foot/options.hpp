#pragma once

// Where a foot may go, and which planes carry one. A wheel is a foot that is as long as it touches
// the ground, a gripper one that is as wide as what it presses on.

namespace planescope::planes {

struct FootOptions {
  double radius_m = 0;  // of the foot, or of the circle about it: any yaw is allowed. 0: no foot
  // How far a foot stays off the outline beyond that: the outline is true to its tolerance of 1 cm.
  double margin_m = 0.01;
  double unknown_share = 0.1;  // of the foot's circle: smaller holes where nothing was seen are
                               // stepped over
  double max_off_m = 0.01;     // of a place from the plane: the foot does not go where it is more
  // A plane is steppable within these.
  double max_slope_deg = 25;
  double min_area_m2 = 0.0025;  // where the foot's centre may go
  double max_rough_m = 0.010;   // RMS of its places
  double min_support = 0.6;     // of the pixels within its outline

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.number("foot_radius_m", "m",
                "of the foot, or of the circle about it, as --foot has it; 0: no foot, and none of "
                "the following means anything",
                &FootOptions::radius_m, {0, 10});
    rows.number("foot_margin_m", "m",
                "how much farther than its radius the foot stays off borders and holes",
                &FootOptions::margin_m, {0, 10});
    rows.number("foot_unknown_share", "share",
                "holes where nothing was measured are stepped over where they are smaller than "
                "this much of the foot's circle",
                &FootOptions::unknown_share);
    rows.number("foot_max_off_m", "m",
                "the foot stays off places that are farther than this from the plane",
                &FootOptions::max_off_m);
    rows.number("foot_max_slope_deg", "deg", "steppable: at most this steep",
                &FootOptions::max_slope_deg, {0, 90});
    rows.number("foot_min_area_m2", "m2", "steppable: at least so much room for the foot's centre",
                &FootOptions::min_area_m2);
    rows.number("foot_max_rough_m", "m", "steppable: RMS of the heights of places at most this",
                &FootOptions::max_rough_m);
    rows.number("foot_min_support", "share",
                "steppable: at least this much of what the outline covers was measured on it",
                &FootOptions::min_support, {0, 1});
  }
};

}  // namespace planescope::planes
