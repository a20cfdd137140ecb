#pragma once

namespace planescope::planes {

/// What counts as a step, and what as steps of one flight.
struct StairsOptions {
  double rise_min_m = 0.03, rise_max_m = 0.30;    // of a step
  double going_min_m = 0.15, going_max_m = 0.50;  // from nosing to nosing
  double width_min_m = 0.2;                       // of a nosing, as far as it is seen
  double rise_spread_m = 0.03;   // a step's rise differs from the next one's by at most this
  double going_spread_m = 0.06;  // likewise its going
  double turn_deg = 12;          // nosings of one flight are parallel within this
  double gap_m = 0.08;           // between a level and the nosing behind it, beyond what is hidden
  double level_deg = 5;          // what is tilted more is a ramp, if it is also steeper than a step
  double landing_goings = 1.5;   // a last level deeper than so many goings is a landing
  double kerb_width_m = 0.6;     // a single step is a kerb from this width on
  double kerb_depth_m = 0.4;     // ... between levels that reach as far before and behind it
  double floor_m2 = 0.1;         // the floor has at least this

  template <typename Rows>
  static void describe(Rows& rows) {
    using O = StairsOptions;
    rows.number("stairs_rise_min_m", "Lowest rise", "m", "minimum rise of a step", &O::rise_min_m, {0.005, 1});
    rows.number("stairs_rise_max_m", "Highest rise", "m", "maximum rise of a step", &O::rise_max_m, {0.005, 2});
    rows.number("stairs_going_min_m", "Shortest going", "m", "minimum going, from nosing to nosing", &O::going_min_m, {0.01, 5});
    rows.number("stairs_going_max_m", "Longest going", "m", "maximum going, from nosing to nosing", &O::going_max_m, {0.01, 5});
    rows.number("stairs_width_min_m", "Least width", "m", "minimum visible width of a nosing", &O::width_min_m, {0.02, 10});
    rows.number("stairs_rise_spread_m", "Spread of rises", "m", "maximum difference of rise between neighboring steps", &O::rise_spread_m, {0, 1});
    rows.number("stairs_going_spread_m", "Spread of goings", "m", "maximum difference of going between neighboring steps", &O::going_spread_m, {0, 1});
    rows.number("stairs_turn_deg", "Angle between nosings", "deg", "maximum angle between nosings of a flight", &O::turn_deg, {0, 45});
    rows.number("stairs_gap_m", "Largest gap", "m", "maximum gap between a level and the nosing behind it, beyond the part hidden by the upper one", &O::gap_m, {0, 1});
    rows.number("stairs_level_deg", "Ramps from this tilt", "deg", "minimum tilt of a ramp; its height must also change by more than stairs_rise_min_m", &O::level_deg, {0, 45});
    rows.number("stairs_landing_goings", "Landings from this depth", "goings", "minimum depth of a landing, in goings of its flight", &O::landing_goings, {1, 100});
    rows.number("stairs_kerb_width_m", "Least kerb width", "m", "minimum width of a kerb, a single step", &O::kerb_width_m, {0, 100});
    rows.number("stairs_kerb_depth_m", "Least depth beside a kerb", "m", "minimum depth of the levels before and behind a kerb", &O::kerb_depth_m, {0, 100});
    rows.number("stairs_floor_m2", "Least floor area", "m2", "minimum area of the floor, the lowest such level", &O::floor_m2, {0, 100});
  }
};

}  // namespace planescope::planes
