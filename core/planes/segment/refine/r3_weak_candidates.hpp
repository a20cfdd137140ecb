#pragma once

// R3: a candidate whose normal is not known well yet waits until those that are sure have been
// merged. It then joins a plane nearby by distance alone, or founds one if enough is known of it.

#include "core/planes/segment/refinement.hpp"

namespace planescope {
struct PlaneFit;
}

namespace planescope::planes::r3_weak_candidates {

struct Options {
  bool on = false;
  double sure_sigma_ang_deg = 4;   // a normal known to this is sure; others wait
  double found_sigma_ang_deg = 8;  // to found a plane of its own, a normal known to this ...
  int found_points = 6;            // ... and so many points

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r3_weak_candidates",
              "R3: candidates with uncertain normals wait for the certain ones", &Options::on);
    rows.number("r3_sure_sigma_ang_deg", "deg", "R3: a normal known to this is certain",
                &Options::sure_sigma_ang_deg, {0, 90});
    rows.number("r3_found_sigma_ang_deg", "deg",
                "R3, split: founding a plane takes a normal known to this",
                &Options::found_sigma_ang_deg, {0, 90});
    rows.number("r3_found_points", "points", "R3, split: founding a plane takes so many points",
                &Options::found_points, {3, 1e9});
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{
    .name = "R3", .title = "weak candidates", .after = After::merging, .turn = 1};

/// Must a candidate wait whose normal is known to sigma_ang [rad]?
bool is_weak(double sigma_ang, const Options& options);
/// Is enough known of it to found a plane of its own?
bool can_found(const PlaneFit& fit, double sigma_ang, const Options& options);

void run(SegmentState& state, const Options& options);

}  // namespace planescope::planes::r3_weak_candidates
