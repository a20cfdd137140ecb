#pragma once

// Limits of footholds and of steppable planes. A wheel is a foot as long as its contact with the
// ground, a gripper one as wide as its pads.

namespace planescope::planes {

struct FootOptions {
  double radius_m = 0;         // the foot, or the circle around it: any yaw is allowed; 0: no foot
  double margin_m = 0.01;      // extra distance from the outline, which is accurate to 1 cm
  double unknown_share = 0.1;  // of the foot's circle: smaller unmeasured holes are ignored
  double max_off_m = 0.01;     // largest distance of a foothold's surface from the plane
  // Limits of a steppable plane.
  double max_slope_deg = 25;
  double min_area_m2 = 0.0025;  // for the center of the foot
  double max_rough_m = 0.010;   // RMS of its height
  double min_support = 0.6;     // share of the outline's pixels that were measured

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.number("foot_radius_m", "Foot radius", "m", "radius of the foot, or of the circle around it (--foot); 0 disables footholds", &FootOptions::radius_m, {0, 10});
    rows.number("foot_margin_m", "Margin around the foot", "m", "extra distance of the foot from borders and holes", &FootOptions::margin_m, {0, 10});
    rows.number("foot_unknown_share", "Unmeasured holes allowed", "share", "unmeasured holes up to this share of the foot's circle are ignored", &FootOptions::unknown_share);
    rows.number("foot_max_off_m", "Largest deviation", "m", "maximum distance of a foothold's surface from the plane", &FootOptions::max_off_m);
    rows.number("foot_max_slope_deg", "Steepest slope", "deg", "steppable planes: maximum slope", &FootOptions::max_slope_deg, {0, 90});
    rows.number("foot_min_area_m2", "Least area", "m2", "steppable planes: minimum area for the center of the foot", &FootOptions::min_area_m2);
    rows.number("foot_max_rough_m", "Largest roughness", "m", "steppable planes: maximum RMS of their height", &FootOptions::max_rough_m);
    rows.number("foot_min_support", "Least support", "share", "steppable planes: minimum share of the outline that was measured", &FootOptions::min_support, {0, 1});
  }
};

}  // namespace planescope::planes
