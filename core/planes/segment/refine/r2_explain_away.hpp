#pragma once

// R2: smallest first, a plane whose points nearly all lie on larger neighbours is an artefact of
// cells that straddle an edge, and one no wider than the noise, or far thinner than the others, or
// whose direction contradicts its label, is noise. Its points are left over again.

#include "core/model/plane.hpp"
#include "core/planes/segment/refinement.hpp"

namespace planescope::planes::r2_explain_away {

struct Options {
  bool on = false;
  // A plane stays where this many of its points are on no larger neighbour, and this share.
  int unexplained_points = 5;
  double unexplained_share = 0.25;
  // All of a small box's top is near its side: on a plane of the other label, points must be
  // closer.
  double other_label_tau = 0.5;   // ... than this share of tau
  double width_sigmas = 1.2;      // RMS across the shorter axis
  double density_share = 0.12;    // of the median plane's points per area
  double contradiction_deg = 15;  // beyond the 45 degrees of Eq. (1)
  double kept_share = 0.5;        // after R5: of its points

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r2_explain_away", "R2: drop planes whose points a larger neighbour explains",
              &Options::on);
    rows.number("r2_unexplained_points", "points",
                "R2: a plane stays with so many points that lie on no larger neighbour",
                &Options::unexplained_points);
    rows.number("r2_unexplained_share", "share",
                "R2: a plane stays with this share of its points on no larger neighbour",
                &Options::unexplained_share, {0, 1});
    rows.number("r2_other_label_tau", "share",
                "R2: on a neighbour of the other label, points lie within this share of tau",
                &Options::other_label_tau);
    rows.number("r2_width_sigmas", "sigma",
                "R2: a plane stays if its RMS width is at least this, more than noise makes",
                &Options::width_sigmas);
    rows.number("r2_density_share", "share",
                "R2: a plane stays if it has this share of the median plane's points per area",
                &Options::density_share);
    rows.number("r2_contradiction_deg", "deg",
                "R2: drop a plane whose normal is this much more than 45 degrees from its label's",
                &Options::contradiction_deg, {0, 45});
    rows.number("r2_kept_share", "share",
                "R2: after R5, a plane stays with this share of the points it was fitted to",
                &Options::kept_share, {0, 1});
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{
    .name = "R2",
    .title = "explain away",
    .says = "larger planes explain {plane}, its points are left over",
    .why_dropped = "larger planes explain it, or it is noise",
    .after = After::merging,
    .turn = 4};

void run(SegmentState& state, const Options& options);
/// Again, once R5 has moved points: a plane that lost most of them to neighbours was made of them.
void drop_emptied_planes(SegmentState& state);

/// Is the region wider across its shorter axis than the noise alone could make it?
bool is_wider_than_noise(const PlaneFit& fit, double sigma_m, const Options& options);
/// Flying pixels along an edge lie on a plane too, but far more thinly than a surface's points.
bool is_dense(const PlaneFit& fit, double typical_area_per_point, const Options& options);

}  // namespace planescope::planes::r2_explain_away
