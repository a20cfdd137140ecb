#pragma once

// R5: where planes meet, each point goes to the nearest of them.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r5_reassign_shared_cells {

struct Options {
  bool on = false;

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r5_reassign_shared_cells", "R5: points in cells that planes share go to the nearest",
              &Options::on);
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{
    .name = "R5",
    .title = "reassign points",
    .says = "point {point} goes from {plane} to {other}, {mm:.1f} mm off it",
    .after = After::assignment,
    .turn = 2};

void run(SegmentState& state, const Options& options);

}  // namespace planescope::planes::r5_reassign_shared_cells
