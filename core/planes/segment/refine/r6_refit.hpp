#pragma once

// R6: points within tau of a second plane pull a fit towards the edge: they are left out of it.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r6_refit {

struct Options {
  bool on = false;
  // A plane is fitted anew if at least so many of its points are near no other, and this share ...
  int sure_points = 10;
  double sure_share = 0.3;
  // ... but of a low riser only a strip is left: to all of its points where the normal would
  // otherwise be known less well, by more than this factor.
  double max_loss = 1.2;

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r6_refit", "R6: refit planes without the points that lie near two of them",
              &Options::on);
    rows.number("r6_sure_points", "points",
                "R6: refit only planes with at least so many points near no other plane",
                &Options::sure_points, {3, 1e9});
    rows.number(
        "r6_sure_share", "share",
        "R6: refit only planes with at least this share of their points near no other plane",
        &Options::sure_share, {0, 1});
    rows.number("r6_max_loss", "1",
                "R6: refit to all points where the normal would be less certain by this factor",
                &Options::max_loss);
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{
    .name = "R6",
    .title = "refit",
    .says = "{plane} fitted anew without the points that a second plane shares",
    .after = After::assignment,
    .turn = 1};

void run(SegmentState& state, const Options& options);

}  // namespace planescope::planes::r6_refit
