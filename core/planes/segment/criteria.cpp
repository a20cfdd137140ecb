// Criteria 1-4 of Sun et al. 2023, as pure functions.

#include "core/planes/segment/criteria.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::planes {

Purity purity_of(const OctreeNode& node, bool use_labels, Label one_label) {
  if (!use_labels) return {one_label, node.size(), 0};
  const std::uint32_t n_h = node.count_h;
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

double area_per_point(const PlaneFit& fit) {
  // The variances of a rectangle are its squared sides over 12.
  return 12 * std::sqrt(fit.eigenvalues[1] * fit.eigenvalues[2]) / (fit.count * fit.count);
}

PairRatios ratios_of(const Coplanarity& terms, const SegmentOptions& options) {
  const double most = std::max(1e-9, 1 - options.theta_coplane);
  PairRatios ratios;
  ratios.angle = std::acos(std::min(1.0, terms.normals)) /
                 std::max(1e-9, std::acos(std::min(1.0, options.theta_coplane)));
  ratios.distance = terms.n1_dmu / most;
  ratios.worst =
      std::max(options.theta_coplane / std::max(1e-9, terms.normals), terms.n1_dmu / most);
  if (options.criterion4_n2) ratios.worst = std::max(ratios.worst, terms.n2_dmu / most);
  if (options.merge_offset_m > 0)
    ratios.worst = std::max(ratios.worst, terms.offset_m / options.merge_offset_m);
  return ratios;
}

// Sun et al. 2023, Sec. IV-B: PCA of a node's inliers and Criterion 3.

Candidate fit_label(const Octree& octree, std::int32_t node, Label label, bool use_labels) {
  Candidate candidate;
  candidate.node = node;
  candidate.label = label;
  const OctreeNode& range = octree.nodes[node];
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    if (use_labels && octree.labels[i] != label) continue;
    candidate.moments.add(octree.points[i].cast<double>());
  }
  candidate.fit = fit_plane(candidate.moments);
  return candidate;
}

Planarity planarity(const PlaneFit& fit, const NoiseModel& noise, const SegmentOptions& options) {
  if (options.by_objective()) {
    const double theta = std::sqrt(options.objective.flat) * noise.constant_m;
    return {fit.rms_m(), theta, is_planar(fit, theta * theta, MseNormalization::mean)};
  }
  return {normal_error(fit, options.mse_normalization), options.theta_e_n_m2,
          is_planar(fit, options.theta_e_n_m2, options.mse_normalization)};
}

}  // namespace planescope::planes
