#include "core/segment/criteria.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planescope {

Purity purity_of(const OctreeNode& node, bool use_labels) {
  const std::uint32_t n_h = use_labels ? node.count_h : node.size();
  const std::uint32_t n_v = node.size() - n_h;
  return n_h >= n_v ? Purity{Label::h, n_h, n_v} : Purity{Label::v, n_v, n_h};
}

bool is_pure(const Purity& purity, const SegmentOptions& options) {
  return purity.n_out <= static_cast<std::uint32_t>(options.theta_n_out) &&
         purity.r_out() <= options.theta_r_out;
}

bool has_enough_inliers(std::uint32_t n_in, const SegmentOptions& options) {
  return n_in >= static_cast<std::uint32_t>(options.theta_n_in);
}

double normal_error(const PlaneFit& fit, MseNormalization normalization) {
  return normalization == MseNormalization::scatter ? fit.eigenvalues[0]
                                                    : fit.eigenvalues[0] / fit.count;
}

bool is_planar(const PlaneFit& fit, double theta_e_n, MseNormalization normalization) {
  return normal_error(fit, normalization) <= theta_e_n;
}

Coplanarity coplanarity(const PlaneFit& plane, const PlaneFit& candidate) {
  const Vec3d dmu = plane.centroid - candidate.centroid;
  const double length = dmu.norm();
  Coplanarity terms;
  terms.normals = std::abs(plane.normal.dot(candidate.normal));
  terms.offset_m = std::abs(plane.normal.dot(dmu));
  if (length > 0) {
    terms.n1_dmu = terms.offset_m / length;
    terms.n2_dmu = std::abs(candidate.normal.dot(dmu)) / length;
  }
  return terms;
}

bool is_coplanar(const Coplanarity& terms, const SegmentOptions& options) {
  return terms.normals >= options.theta_coplane && terms.n1_dmu <= 1 - options.theta_coplane &&
         (!options.criterion4_n2 || terms.n2_dmu <= 1 - options.theta_coplane) &&
         (options.merge_offset_m <= 0 || terms.offset_m <= options.merge_offset_m);
}

double normal_uncertainty(const PlaneFit& fit, double sigma_m) {
  const double noise =
      std::max(fit.eigenvalues[0] / std::max(1.0, fit.count - 3), sigma_m * sigma_m / 4);
  if (fit.eigenvalues[1] <= 0) return std::numbers::pi / 2;
  return std::min(std::numbers::pi / 2, std::sqrt(noise / fit.eigenvalues[1]));
}

bool is_wider_than_noise(const PlaneFit& fit, double sigma_m) {
  return std::sqrt(fit.eigenvalues[1] / fit.count) >= 2 * sigma_m;
}

double area_per_point(const PlaneFit& fit) {
  // A rectangle's variances are its squared sides over 12.
  return 12 * std::sqrt(fit.eigenvalues[1] * fit.eigenvalues[2]) / (fit.count * fit.count);
}

bool is_dense(const PlaneFit& fit, double typical_area_per_point) {
  constexpr double kLeastShare = 0.12;
  return kLeastShare * area_per_point(fit) <= typical_area_per_point;
}

DistanceTerms distance_terms(const MeasuredPlane& a, const MeasuredPlane& b) {
  const MeasuredPlane& sure = b.sigma_ang < a.sigma_ang ? b : a;
  const MeasuredPlane& other = b.sigma_ang < a.sigma_ang ? a : b;
  constexpr double kDeg = 180 / std::numbers::pi;
  constexpr double kMaxLateral2 = 0.25;  // [m^2]: the bound stops growing half a metre away

  constexpr double kNear = 0.1;    // [m]: regions this close are neighbours
  constexpr double kFarAngle = 5;  // [deg]: over a gap, directions must agree better

  const Vec3d& n = sure.fit.normal;
  const Vec3d dmu = other.fit.centroid - sure.fit.centroid;
  const double offset = n.dot(dmu);
  const double lateral2 = std::max(0.0, dmu.squaredNorm() - offset * offset);
  DistanceTerms terms;
  terms.gap_m = gap_between(a.bounds, b.bounds);
  terms.max_gap_m = std::max(kNear, other.tau_m / (3 * std::max(other.sigma_ang, 1e-9)));
  terms.angle_deg = kDeg * std::acos(std::min(1.0, std::abs(n.dot(other.fit.normal))));
  terms.max_angle_deg = terms.gap_m <= kNear ? 10 + 3 * kDeg * other.sigma_ang : kFarAngle;
  terms.offset2_m2 = offset * offset;
  terms.spread2_m2 = n.dot(other.moments.scatter() * n) / other.moments.count;
  terms.bound2_m2 = other.tau_m * other.tau_m +
                    9 * sure.sigma_ang * sure.sigma_ang * std::min(lateral2, kMaxLateral2);
  return terms;
}

PairStrain strain_of(const Coplanarity& terms, const SegmentOptions& options) {
  const double most = std::max(1e-9, 1 - options.theta_coplane);
  PairStrain strain;
  strain.angle = std::acos(std::min(1.0, terms.normals)) /
                 std::max(1e-9, std::acos(std::min(1.0, options.theta_coplane)));
  strain.distance = terms.n1_dmu / most;
  strain.worst =
      std::max(options.theta_coplane / std::max(1e-9, terms.normals), terms.n1_dmu / most);
  if (options.criterion4_n2) strain.worst = std::max(strain.worst, terms.n2_dmu / most);
  if (options.merge_offset_m > 0)
    strain.worst = std::max(strain.worst, terms.offset_m / options.merge_offset_m);
  return strain;
}

PairStrain strain_of(const DistanceTerms& terms) {
  PairStrain strain;
  strain.angle = terms.angle_deg / terms.max_angle_deg;
  strain.distance = std::sqrt(terms.offset2_m2 / terms.bound2_m2);
  strain.worst = std::max({strain.angle, terms.gap_m / terms.max_gap_m, strain.distance,
                           std::sqrt(std::max(0.0, terms.spread2_m2) / terms.bound2_m2)});
  return strain;
}

}  // namespace planescope
