#pragma once

// The numbers of the one objective by which planes of clouds are found (cloud_regions.hpp). None of
// them is a length: the scale is the noise measured in the cloud, called sigma below.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::objective {

struct Options {
  bool on = false;
  double calm = 0.5;         // quantile of the cells' RMS that is the noise
  double resolution = 0.05;  // of the points' spacing: sigma is at least this
  double bow = 2.5;          // times the offset between neighboring cells that noise leaves open
  double flat = 3;           // variance of a node (Criterion 3), over that of noise and bow
  double merge = 10;         // regions merge below this ratio of squared offset to variance
  double reach = 4.5;        // sigma: an unexplained point costs as much as one this far off
  double label = 2;          // sigma: a plane of the other label seems this much farther off
  double worth = 220;        // squared sigma: what a plane costs
  int rounds = 4;            // of moving points, fitting and merging, at most

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("objective", "find planes by one objective in place of all refinements",
              &Options::on);
    rows.number("objective_calm", "share", "sigma is this quantile of the cells' RMS",
                &Options::calm, {0, 1});
    rows.number("objective_resolution", "spacings", "sigma is at least this, in point spacings",
                &Options::resolution);
    rows.number("objective_bow", "1",
                "low-frequency error, as a multiple of the offset between neighboring cells",
                &Options::bow);
    rows.number("objective_flat", "1",
                "Criterion 3: largest variance of a node, over that of noise and bow",
                &Options::flat);
    rows.number("objective_merge", "1",
                "merge regions below this ratio of squared offset to its variance",
                &Options::merge);
    rows.number("objective_reach", "sigma",
                "an unexplained point costs as much as one this far from its plane",
                &Options::reach);
    rows.number("objective_label", "sigma",
                "a plane of the other label counts as farther from a point by this",
                &Options::label);
    rows.number("objective_worth", "sigma2", "cost of a plane", &Options::worth);
    rows.number("objective_rounds", "1",
                "most rounds of moving points, fitting planes and merging them", &Options::rounds,
                {0, 100});
  }
};
inline constexpr Options kRefined{};
inline constexpr RefinementInfo kInfo{
    .name = "objective",
    .title = "one objective",
    .says = "{plane} goes into {other} (-: it is dropped), by {value:.2f}",
    .why_dropped = "it is worth {value:.0f}, less than objective_worth",
    .why_parted = "they do not touch"};

}  // namespace planescope::planes::objective
