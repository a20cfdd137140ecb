#pragma once

// R4: an impure node whose labels are each planar is fitted label by label, instead of being
// divided until the labels are separate. It acts in the traversal (traverse.cpp).

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r4_fit_impure_nodes {

struct Options {
  bool on = false;

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r4_fit_impure_nodes",
              "R4: fit each label's points of an impure node before dividing it", &Options::on);
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{.name = "R4", .title = "fit impure nodes"};

}  // namespace planescope::planes::r4_fit_impure_nodes
