#pragma once

// R1: candidates and planes are merged by how far they lie from each other, not by direction as in
// Criterion 4, which accepts a larger step the farther apart two centroids are.

#include "core/model/plane.hpp"
#include "core/planes/segment/refinement.hpp"

namespace planescope::planes {

namespace r1_merge_by_distance {

struct Options {
  bool on = false;
  double max_angle_deg = 10;  // between the normals of neighbours ...
  double angle_sigmas = 3;    // ... and this many sigma of the less sure one on top
  double near_m = 0.1;        // regions whose boxes are this close are neighbours
  double far_angle_deg = 5;   // over a wider gap, directions must agree better ...
  double gap_sigmas = 3;      // ... and the less sure normal must hit tau across it
  double offset_sigmas = 3;   // offset and spread: tau, and this many sigma of the surer normal ...
  double max_lateral_m = 0.5;  // ... times the distance of the centroids, at most this

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("r1_merge_by_distance",
              "R1: merge by distance and RMS; leftovers go to a plane with points nearby",
              &Options::on);
    rows.number("r1_max_angle_deg", "deg",
                "R1: neighbours' normals differ by at most this and r1_angle_sigmas",
                &Options::max_angle_deg, {0, 90});
    rows.number(
        "r1_angle_sigmas", "sigma",
        "R1: neighbours' normals may differ by this much more, in sigma of the less sure one",
        &Options::angle_sigmas);
    rows.number("r1_near_m", "m", "R1: regions whose boxes are this close are neighbours",
                &Options::near_m);
    rows.number("r1_far_angle_deg", "deg", "R1: over a wider gap, normals differ by at most this",
                &Options::far_angle_deg, {0, 90});
    rows.number("r1_gap_sigmas", "sigma",
                "R1: a gap is at most so wide that this many sigma of the less sure normal stay "
                "within tau",
                &Options::gap_sigmas, {0, 1000, true});
    rows.number(
        "r1_offset_sigmas", "sigma",
        "R1: offset and spread may exceed tau by this many sigma of the surer normal, times its "
        "lever",
        &Options::offset_sigmas);
    rows.number("r1_max_lateral_m", "m",
                "R1: the lever of r1_offset_sigmas is the centroids' distance, at most this",
                &Options::max_lateral_m);
  }
};
inline constexpr Options kRefined{.on = true};
inline constexpr RefinementInfo kInfo{.name = "R1", .title = "merge by distance"};

}  // namespace r1_merge_by_distance

/// R1: coplanarity by distance. The surer of the two planes measures the other.
struct DistanceTerms {
  double angle_deg = 0, max_angle_deg = 0;
  bool any_angle = false;  // R3: a weak candidate's own direction says nothing
  double gap_m = 0,
         max_gap_m = 0;   // between the regions' boxes; as far as the normals can be trusted
  double offset2_m2 = 0;  // squared distance of the other's centroid
  double spread2_m2 = 0;  // n^T S n / N of the other
  double bound2_m2 = 0;   // both must stay below
  bool passes() const {
    return (any_angle || angle_deg <= max_angle_deg) && gap_m <= max_gap_m &&
           offset2_m2 <= bound2_m2 && spread2_m2 <= bound2_m2;
  }
  double cost() const { return bound2_m2 > 0 ? (offset2_m2 + spread2_m2) / bound2_m2 : 0; }
};
struct MeasuredPlane {
  const PlaneFit& fit;
  const Moments& moments;
  double sigma_ang = 0;  // normal_uncertainty [rad]
  double tau_m = 0;      // how far off its points may lie, for noise
  const Bounds& bounds;  // of its points
};
/// Whether offset or gap alone keeps the two apart: cheap, and asked before distance_terms().
bool are_out_of_reach(const MeasuredPlane& a,
                      const MeasuredPlane& b,
                      const r1_merge_by_distance::Options& options);
DistanceTerms distance_terms(const MeasuredPlane& a,
                             const MeasuredPlane& b,
                             const r1_merge_by_distance::Options& options);

}  // namespace planescope::planes
