#pragma once

// Coplanar regions that do not touch become planes of their own, which is what a foothold planner
// needs: in every gap, or in those that the sensor looked through (of clouds, in every one).

#include <cstdint>

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes {

/// Which gaps within a plane make two of it: none, those that the sensor looked through, or all.
enum class SplitRule : std::uint8_t { off, seen, on };

namespace split_disconnected {

struct Options {
  SplitRule rule = SplitRule::off;
  double gap_m = 0.05;         // points no farther apart than this touch ...
  double gap_spacings = 2;     // ... nor, by `seen`, than this many spacings of the points
  double sight_cell_m = 0.02;  // what was looked through is marked on a grid of this cell
  double behind_m = 0.03;      // what is nearer behind a plane may be noise of it ...
  double behind_taus = 2;      // ... likewise
  double open_share = 0.5;     // of a gap must have been looked through

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.choice("split_disconnected", {"off", "seen", "on"},
                "split planes into parts that do not touch; seen: where the sensor looked through "
                "the gap",
                &Options::rule);
    rows.number("split_gap_m", "m", "points no farther apart than this touch", &Options::gap_m,
                {0.005, 10});
    rows.number("split_gap_spacings", "1",
                "split seen: points closer than this many point spacings touch, too",
                &Options::gap_spacings, {0, 1000});
    rows.number("split_sight_cell_m", "m",
                "split seen: edge of the cells that were looked through or not",
                &Options::sight_cell_m, {0.001, 100});
    rows.number("split_behind_m", "m",
                "split seen: rays that end this far behind a plane passed it", &Options::behind_m);
    rows.number("split_behind_taus", "tau",
                "split seen: rays that end this far behind a plane passed it, in tau there",
                &Options::behind_taus);
    rows.number("split_open_share", "share",
                "split seen: a gap is open where rays passed this share of it",
                &Options::open_share, {0, 1});
  }
};
inline constexpr Options kRefined{.rule = SplitRule::seen};
inline constexpr RefinementInfo kInfo{.name = "split",
                                      .title = "split disconnected planes",
                                      .says = "{plane} fitted anew to the points it has",
                                      .why_parted = "they do not touch",
                                      .after = After::assignment,
                                      .turn = 3};

void run(SegmentState& state, const Options& options);

}  // namespace split_disconnected
}  // namespace planescope::planes
