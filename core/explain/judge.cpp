#include "core/explain/judge.hpp"

#include <algorithm>

namespace planescope {
namespace {

/// The true plane with most points; 0 where none has any.
std::int32_t majority(const std::vector<std::uint32_t>& counts) {
  const auto most = std::max_element(counts.begin(), counts.end());
  return most == counts.end() || *most == 0 ? 0 : static_cast<std::int32_t>(most - counts.begin());
}

Judgement wrong_if(bool wrong) { return wrong ? Judgement::wrong : Judgement::right; }

}  // namespace

Judgement judge_node(const Run& run, std::int32_t node) {
  const NodeFacts& facts = run.facts[node];
  if (facts.truth_planes == 0) return Judgement::unknown;
  switch (run.octree().nodes[node].decided) {
    case Case::IV:
      return wrong_if(facts.truth_planes > 1);
    case Case::I:
    case Case::III:
      return wrong_if(facts.truth_planes == 1 &&
                      facts.truth_points >=
                          static_cast<std::uint32_t>(run.segment_options.theta_n_in));
    default:
      return Judgement::right;
  }
}

TruthWalk::TruthWalk(const Run& run)
    : run_(run),
      counts_(run.timeline.plane_count(),
              std::vector<std::uint32_t>(run.subject->voxel_truth.plane_count + 1, 0)) {}

Judgement TruthWalk::next() {
  const TraceEvent& event = run_.trace.events[static_cast<std::size_t>(step_++)];
  if (!run_.subject->voxel_truth.known()) return Judgement::unknown;
  if (event.type == EventType::refine && event.refinement == 7)
    std::transform(counts_[event.other].begin(), counts_[event.other].end(),
                   counts_[event.plane].begin(), counts_[event.other].begin(), std::plus<>());
  const bool candidate = event.type == EventType::found || event.type == EventType::merge;
  if (candidate && event.node < 0) return Judgement::unknown;  // split off
  const std::vector<std::uint32_t> part =
      candidate ? counts_of(event) : std::vector<std::uint32_t>();
  const Judgement judgement = judge(event, part);
  for (std::size_t t = 0; t < part.size(); ++t) counts_[event.plane][t] += part[t];
  return judgement;
}

std::vector<std::uint32_t> TruthWalk::counts_of(const TraceEvent& candidate) const {
  const VoxelTruth& truth = run_.subject->voxel_truth;
  const Octree& octree = run_.octree();
  const OctreeNode& node = octree.nodes[candidate.node];
  std::vector<std::uint32_t> counts(truth.plane_count + 1, 0);
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    const std::int32_t plane = truth.plane[octree.order[i]];
    if (plane > 0 && (!run_.segment_options.use_labels || octree.labels[i] == candidate.label))
      ++counts[plane];
  }
  return counts;
}

Judgement TruthWalk::judge(const TraceEvent& event, const std::vector<std::uint32_t>& part) const {
  const VoxelTruth& truth = run_.subject->voxel_truth;
  if (event.type == EventType::assign || event.type == EventType::drop) {
    const std::int32_t own = truth.plane[event.point];
    if (own < 0) return Judgement::unknown;
    return wrong_if(own != (event.plane >= 0 ? majority(counts_[event.plane]) : 0));
  }
  const std::int32_t own = majority(part);
  if (own == 0) return Judgement::unknown;
  if (event.type == EventType::merge) return wrong_if(majority(counts_[event.plane]) != own);
  return wrong_if(std::any_of(counts_.begin(), counts_.begin() + event.plane,
                              [&](const auto& counts) { return majority(counts) == own; }));
}

}  // namespace planescope
