#include "core/planes/segment/refine/r1_merge_by_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planescope::planes {

double max_gap_m(double sigma_ang, double tau_m, const r1_merge_by_distance::Options& options) {
  return std::max(options.near_m, tau_m / (options.gap_sigmas * std::max(sigma_ang, 1e-9)));
}

DistanceTerms distance_terms(const MeasuredPlane& a,
                             const MeasuredPlane& b,
                             const r1_merge_by_distance::Options& options) {
  const MeasuredPlane& sure = b.sigma_ang < a.sigma_ang ? b : a;
  const MeasuredPlane& other = b.sigma_ang < a.sigma_ang ? a : b;
  constexpr double kDeg = 180 / std::numbers::pi;
  const Vec3d& n = sure.fit.normal;
  const Vec3d dmu = other.fit.centroid - sure.fit.centroid;
  const double offset = n.dot(dmu);
  const double lateral2 = std::max(0.0, dmu.squaredNorm() - offset * offset);
  const double max_lateral2 = options.max_lateral_m * options.max_lateral_m;
  DistanceTerms terms;
  terms.gap_m = gap_between(a.bounds, b.bounds);
  terms.max_gap_m = max_gap_m(other.sigma_ang, other.tau_m, options);
  terms.angle_deg = kDeg * std::acos(std::min(1.0, std::abs(n.dot(other.fit.normal))));
  terms.max_angle_deg = terms.gap_m <= options.near_m
                            ? options.max_angle_deg + options.angle_sigmas * kDeg * other.sigma_ang
                            : options.far_angle_deg;
  terms.offset2_m2 = offset * offset;
  terms.spread2_m2 = n.dot(other.moments.scatter() * n) / other.moments.count;
  terms.bound2_m2 = other.tau_m * other.tau_m + options.offset_sigmas * options.offset_sigmas *
                                                    sure.sigma_ang * sure.sigma_ang *
                                                    std::min(lateral2, max_lateral2);
  return terms;
}

}  // namespace planescope::planes
