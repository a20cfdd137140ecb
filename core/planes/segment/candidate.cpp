// Sun et al. 2023, Sec. IV-B: PCA of a node's inliers and Criterion 3.

#include "core/planes/segment/candidate.hpp"

namespace planescope::planes {

Candidate fit_label(const Octree& octree, std::int32_t node, Label label, bool use_labels) {
  Candidate candidate;
  candidate.node = node;
  candidate.label = label;
  const OctreeNode& range = octree.nodes[node];
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    if (use_labels && octree.labels[i] != label) continue;
    octree.add_point(candidate.moments, i);
    candidate.bounds.add(octree.points[i].cast<double>());
  }
  candidate.fit = fit_plane(candidate.moments);
  return candidate;
}

Planarity planarity(const PlaneFit& fit,
                    const NoiseModel& noise,
                    double range_m,
                    const SegmentOptions& options) {
  if (options.noise.rms_criterion3) {
    const double theta = noise.theta_rms(range_m);
    return {fit.rms_m(), theta, is_planar(fit, theta * theta, MseNormalization::mean)};
  }
  return {normal_error(fit, options.mse_normalization), options.theta_e_n_m2,
          is_planar(fit, options.theta_e_n_m2, options.mse_normalization)};
}

}  // namespace planescope::planes
