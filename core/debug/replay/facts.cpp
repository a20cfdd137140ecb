#include "core/debug/replay/facts.hpp"

#include "core/planes/segment/criteria.hpp"

namespace planescope::debug {
namespace {

/// Counts the true planes of one node after the other.
class TruthCounter {
 public:
  TruthCounter(const planes::Octree& octree, const VoxelTruth& truth)
      : octree_(octree), truth_(truth), points_(truth.plane_count + 1, 0) {}

  void count(const planes::OctreeNode& node, NodeFacts& facts) {
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::int32_t plane = truth_.plane[octree_.order[i]];
      if (plane <= 0) continue;
      ++facts.truth_known;
      if (++points_[plane] == 1) seen_.push_back(plane);
    }
    facts.truth_planes = static_cast<std::uint32_t>(seen_.size());
    for (const std::int32_t plane : seen_) {
      const bool more = points_[plane] > facts.truth_points;
      if (more || (points_[plane] == facts.truth_points && plane < facts.truth_plane)) {
        facts.truth_plane = plane;
        facts.truth_points = points_[plane];
      }
    }
    for (const std::int32_t plane : seen_) points_[plane] = 0;
    seen_.clear();
  }

 private:
  const planes::Octree& octree_;
  const VoxelTruth& truth_;
  std::vector<std::uint32_t> points_;  // per true plane, all 0 between two nodes
  std::vector<std::int32_t> seen_;
};

}  // namespace

std::vector<NodeFacts> facts_of(const Run& run) {
  const planes::Octree& octree = run.octree();
  const planes::SegmentOptions& options = run.segment_options;
  const planes::NoiseModel& noise = run.segmentation.noise;
  const VoxelTruth& truth = run.subject->voxel_truth;
  TruthCounter counter(octree, truth);
  std::vector<NodeFacts> result;
  result.reserve(octree.nodes.size());
  for (const planes::OctreeNode& node : octree.nodes) {
    NodeFacts facts;
    facts.purity = planes::purity_of(node, options.use_labels, options.one_label);
    facts.fit = planes::fit_label(octree, static_cast<std::int32_t>(result.size()),
                                  facts.purity.inlier, options.use_labels)
                    .fit;
    const double range = (facts.fit.centroid - run.subject->prepared.sensor()).norm();
    const planes::Planarity planar = planes::planarity(facts.fit, noise, range, options);
    facts.e_n = planar.value;
    facts.theta_e_n = planar.threshold;
    facts.sigma_ang =
        planes::normal_uncertainty(facts.fit, noise.sigma(range), options.noise.normal_sigma_share);
    if (truth.known()) counter.count(node, facts);
    result.push_back(facts);
  }
  return result;
}

}  // namespace planescope::debug
