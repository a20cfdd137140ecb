#include "core/planes/segment/refine/r1_merge_by_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planescope::planes {

namespace {

struct Roles {
  const MeasuredPlane &sure, &other;
};
Roles roles_of(const MeasuredPlane& a, const MeasuredPlane& b) {
  if (b.sigma_ang < a.sigma_ang) return {b, a};
  return {a, b};
}

/// Squared distance of the other's centroid from the surer one, and what it may be.
struct Offset {
  double offset2_m2 = 0, bound2_m2 = 0;
};
Offset offset_of(const Roles& roles, const r1_merge_by_distance::Options& options) {
  const auto& [sure, other] = roles;
  const Vec3d dmu = other.fit.centroid - sure.fit.centroid;
  const double offset = sure.fit.normal.dot(dmu);
  const double lateral2 = std::max(0.0, dmu.squaredNorm() - offset * offset);
  const double max_lateral2 = options.max_lateral_m * options.max_lateral_m;
  return {offset * offset, other.tau_m * other.tau_m +
                               options.offset_sigmas * options.offset_sigmas * sure.sigma_ang *
                                   sure.sigma_ang * std::min(lateral2, max_lateral2)};
}

/// How far apart the boxes of two planes may be, by the less sure one's normal and tau.
double max_gap_m(const MeasuredPlane& other, const r1_merge_by_distance::Options& options) {
  return std::max(options.near_m,
                  other.tau_m / (options.gap_sigmas * std::max(other.sigma_ang, 1e-9)));
}

}  // namespace

bool are_out_of_reach(const MeasuredPlane& a,
                      const MeasuredPlane& b,
                      const r1_merge_by_distance::Options& options) {
  const Roles roles = roles_of(a, b);
  if (const Offset o = offset_of(roles, options); o.offset2_m2 > o.bound2_m2) return true;
  const double gap_m = gap_between(a.bounds, b.bounds);
  return gap_m > options.near_m && gap_m > max_gap_m(roles.other, options);
}

DistanceTerms distance_terms(const MeasuredPlane& a,
                             const MeasuredPlane& b,
                             const r1_merge_by_distance::Options& options) {
  const Roles roles = roles_of(a, b);
  const auto& [sure, other] = roles;
  constexpr double kDeg = 180 / std::numbers::pi;
  const Vec3d& n = sure.fit.normal;
  const Offset offset = offset_of(roles, options);
  DistanceTerms terms;
  terms.gap_m = gap_between(a.bounds, b.bounds);
  terms.max_gap_m = max_gap_m(other, options);
  terms.angle_deg = kDeg * std::acos(std::min(1.0, std::abs(n.dot(other.fit.normal))));
  terms.max_angle_deg = terms.gap_m <= options.near_m
                            ? options.max_angle_deg + options.angle_sigmas * kDeg * other.sigma_ang
                            : options.far_angle_deg;
  terms.offset2_m2 = offset.offset2_m2;
  terms.spread2_m2 = n.dot(other.moments.scatter() * n) / other.moments.count;
  terms.bound2_m2 = offset.bound2_m2;
  return terms;
}

}  // namespace planescope::planes
