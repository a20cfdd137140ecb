#pragma once

// R7: when all planes are known, they are merged once more, small into large, until nothing
// changes. In the order of founding, early candidates stay apart whose normals were still poor.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r7_second_merge {

struct Options {
  bool on = false;

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r7_second_merge", "R7: a second pass of merging", &Options::on);
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{.name = "R7",
                                      .title = "second merge",
                                      .says = "{plane} merges into {other}",
                                      .after = After::merging,
                                      .turn = 2};

void run(SegmentState& state, const Options& options);

}  // namespace planescope::planes::r7_second_merge
