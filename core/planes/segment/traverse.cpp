// Sun et al. 2023, Sec. IV-B (cases I-IV) and IV-C (traversal).

#include <optional>

#include "core/planes/segment/state.hpp"

namespace planescope::planes {
namespace {

/// Criterion 3.
bool planar(const SegmentState& state, const Candidate& candidate) {
  const Planarity asked = planarity(candidate.fit, state.noise, state.options);
  if (state.trace)
    state.trace->strains.planarity.push_back(static_cast<float>(asked.value / asked.threshold));
  return asked.passes;
}

void leave_over(SegmentState& state, std::int32_t index, std::optional<Label> except = {}) {
  const OctreeNode& node = state.octree.nodes[index];
  for (std::uint32_t i = node.begin; i < node.end; ++i)
    if (!except || !state.has_label(i, *except)) leave_point(state, i);
}

void settle(SegmentState& state, std::int32_t index, Case decided, double e_n) {
  log(state, {.type = EventType::decide,
              .node_case = static_cast<std::uint8_t>(decided),
              .node = index,
              .value = static_cast<float>(e_n)});
  settle_node(state, index, decided);
}

void divide_or_leave(SegmentState& state, std::int32_t index) {
  OctreeNode& node = state.octree.nodes[index];
  if (node.depth < state.octree.cube.max_depth) {
    divide_node(state, index);
  } else {
    node.at_max_depth = true;
    leave_over(state, index);
  }
}

void accept(SegmentState& state, const Candidate& candidate) {
  ++state.counts.candidates;
  if (state.options.by_objective())
    found(state, candidate, Stage::criteria);
  else
    conquer(state, candidate);
}

Candidate candidate_of(const SegmentState& state, std::int32_t node, Label label) {
  return fit_label(state.octree, node, label, state.options.use_labels);
}

/// By the objective, an impure node whose labels are each planar (or too few to matter) is accepted
/// label by label instead of being divided down to where the labels part.
bool accept_by_label(SegmentState& state, std::int32_t index, const Purity& purity) {
  if (!has_enough_inliers(purity.n_in, state.options)) return false;
  Candidate inliers = candidate_of(state, index, purity.inlier);
  if (!planar(state, inliers)) return false;
  const Label outlier = purity.inlier == Label::h ? Label::v : Label::h;
  const bool both = has_enough_inliers(purity.n_out, state.options);
  Candidate outliers;
  if (both) {
    outliers = candidate_of(state, index, outlier);
    if (!planar(state, outliers)) return false;
  }
  state.octree.nodes[index].by_label = true;
  if (!both) leave_over(state, index, purity.inlier);
  accept(state, inliers);
  if (both) accept(state, outliers);
  return true;
}

void visit(SegmentState& state, std::int32_t index) {
  visit_node(state, index);
  const Purity purity =
      purity_of(state.octree.nodes[index], state.options.use_labels, state.options.one_label);

  if (!is_pure(purity, state.options)) {  // Case I
    settle(state, index, Case::I, 0);
    if (state.options.by_objective() && accept_by_label(state, index, purity)) return;
    divide_or_leave(state, index);
    return;
  }
  if (!has_enough_inliers(purity.n_in, state.options)) {  // Case II
    settle(state, index, Case::II, 0);
    leave_over(state, index);
    return;
  }
  const Candidate candidate = candidate_of(state, index, purity.inlier);
  const bool is_plane = planar(state, candidate);
  settle(state, index, is_plane ? Case::IV : Case::III, candidate.fit.eigenvalues[0]);
  if (!is_plane) {  // Case III
    divide_or_leave(state, index);
    return;
  }
  leave_over(state, index, purity.inlier);  // Case IV
  accept(state, candidate);
}

}  // namespace

void traverse(SegmentState& state) {
  // The node array grows as nodes are divided: it is the queue Q_N.
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(state.octree.nodes.size()); ++i)
    visit(state, i);
}

}  // namespace planescope::planes
