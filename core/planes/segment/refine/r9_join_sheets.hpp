#pragma once

// R9: real depth bows, by a centimetre and more and alike over far more than a cell, so that pieces
// of one surface fail R1. Planes whose pixels touch are judged where they meet: if the depth goes
// on there without a step, and the smaller one misses the larger by no more than the bow, they are
// one.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r9_join_sheets {

struct Options {
  bool on = false;
  // In metres: at 1 m; they grow with the square of range, as the error of stereo does.
  double misfit_m = 0.028;  // RMS of the smaller plane's pixels about the larger plane
  double step_m = 0.0035;   // mean step of the depth along the border
  double step_own = 1;      // by the larger RMS of either about itself: no noise hides a step
  double max_angle_deg = 30;
  int border_px = 8;  // of common border, at least

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r9_join_sheets",
              "R9: depth images: join planes that go on into each other where they touch",
              &Options::on);
    rows.number("r9_misfit_m", "m", "R9: largest RMS of the smaller plane about the larger, at 1 m",
                &Options::misfit_m);
    rows.number("r9_step_m", "m", "R9: largest mean step of the depth along their border, at 1 m",
                &Options::step_m);
    rows.number("r9_step_own", "1",
                "R9: and at most so many times the larger RMS of either about itself",
                &Options::step_own);
    rows.number("r9_max_angle_deg", "deg", "R9: largest angle between them",
                &Options::max_angle_deg, {0, 180});
    rows.number("r9_border_px", "px", "R9: least length of their border", &Options::border_px,
                {1, 1e9});
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{
    .name = "R9",
    .title = "join sheets",
    .says = "{plane} goes on into {other} where they touch, and merges into it",
    .after = After::assignment,
    .turn = 4,
    .on_pixels = true};

void run(SegmentState& state, const Options& options);

}  // namespace planescope::planes::r9_join_sheets
