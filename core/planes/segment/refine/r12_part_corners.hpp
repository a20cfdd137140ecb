#pragma once

// R12: where depth is known to no better than a centimetre, two faces that meet at an edge pass
// Criterion 3 as one plane across it, with the normal of neither. With all its pixels a plane is
// fitted once more, by two planes that meet in a line: where these fit much better, it is two.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r12_part_corners {

struct Options {
  bool on = false;
  double rms_share = 0.8;     // of the RMS about one plane, that the RMS about two is at most
  double min_angle_deg = 35;  // between the two
  double least_share = 0.08;  // of the pixels, that the smaller has at least

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r12_part_corners", "R12: depth images: part a plane that cuts across an edge",
              &Options::on);
    rows.number("r12_rms_share", "1",
                "R12: largest RMS about two planes that meet, by that about one",
                &Options::rms_share, {0, 1});
    rows.number("r12_min_angle_deg", "deg", "R12: least angle between the two",
                &Options::min_angle_deg, {0, 180});
    rows.number("r12_least_share", "1", "R12: least share of the smaller one's pixels",
                &Options::least_share, {0, 0.5});
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{.name = "R12",
                                      .title = "part corners",
                                      .says = "{plane} cuts across an edge, and keeps one side",
                                      .why_parted = "they meet at an edge",
                                      .after = After::merging,
                                      .turn = 3,
                                      .on_pixels = true};

void run(SegmentState& state, const Options& options);

}  // namespace planescope::planes::r12_part_corners
