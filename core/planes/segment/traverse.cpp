// Sun et al. 2023, Sec. IV: the traversal, Criterion 4 with incremental merging, and
// leftover points.

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/planes/segment/state.hpp"

namespace planescope::planes {

// ---- Sec. IV-B (cases I-IV) and IV-C (traversal) ----

namespace {

/// Criterion 3.
bool planar(const SegmentState& state, const Candidate& candidate) {
  const Planarity asked = planarity(candidate.fit, state.noise, state.options);
  if (state.trace)
    state.trace->limit_ratios.planarity.push_back(
        static_cast<float>(asked.value / asked.threshold));
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

/// With the objective, an impure node whose labels are each planar (or too few to matter) is
/// accepted label by label, instead of being divided until the labels separate.
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
  // The node array grows as nodes are divided: it serves as the queue Q_N.
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(state.octree.nodes.size()); ++i)
    visit(state, i);
}

// ---- Sec. IV-C (Criterion 4) and IV-D (incremental merge) ----

namespace {

void claim_points(SegmentState& state, const Candidate& candidate, std::int32_t plane) {
  const OctreeNode& node = state.octree.nodes[candidate.node];
  for (std::uint32_t i = node.begin; i < node.end; ++i)
    if (state.has_label(i, candidate.label)) give_point(state, i, plane);
}

/// Traces the chosen pair or, if none was chosen, the pair closest to passing.
void trace_ratios(const SegmentState& state, const std::vector<Pair>& pairs, std::int32_t chosen) {
  const auto joined = std::ranges::find(pairs, chosen, &Pair::plane);
  const Pair* shown = joined != pairs.end() ? &*joined : nearest_pair(pairs, state.options);
  if (!shown) return;
  const PairRatios ratios = ratios_of(shown->terms, state.options);
  if (std::isinf(ratios.worst)) return;
  state.trace->limit_ratios.angle.push_back(static_cast<float>(ratios.angle));
  state.trace->limit_ratios.distance.push_back(static_cast<float>(ratios.distance));
}

}  // namespace

const Pair* nearest_pair(std::span<const Pair> pairs, const SegmentOptions& options) {
  const Pair* nearest = nullptr;
  double least = INFINITY;
  for (const Pair& pair : pairs)
    if (const double worst = ratios_of(pair.terms, options).worst; worst < least) {
      nearest = &pair;
      least = worst;
    }
  return nearest;
}

std::int32_t choose_partner(const SegmentState& state,
                            const Candidate& candidate,
                            const PairVisitor* visitor) {
  std::int32_t best = -1;
  double least_m = 0;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    if (!state.planes[k].alive) continue;
    const Coplanarity terms = coplanarity(state.planes[k].fit, candidate.fit);
    const Pair pair{k, terms, is_coplanar(terms, state.options)};
    if (visitor) (*visitor)(pair);
    if (!pair.coplanar || (best >= 0 && terms.offset_m >= least_m)) continue;
    best = k;
    least_m = terms.offset_m;
    if (state.options.merge_partner == MergePartner::first) break;
  }
  return best;
}

void found(SegmentState& state, const Candidate& candidate, Stage stage) {
  log(state, {.type = EventType::found,
              .stage = stage,
              .label = candidate.label,
              .node = candidate.node,
              .plane = static_cast<std::int32_t>(state.planes.size())});
  const std::int32_t plane = found_plane(
      state, {.label = candidate.label, .moments = candidate.moments, .fit = candidate.fit});
  claim_points(state, candidate, plane);
}

void merge(SegmentState& state, const Candidate& candidate, std::int32_t plane) {
  const double offset = state.planes[plane].fit.distance_m(candidate.fit.centroid);
  log(state, {.type = EventType::merge,
              .stage = Stage::merge,
              .label = candidate.label,
              .node = candidate.node,
              .plane = plane,
              .value = static_cast<float>(std::abs(offset))});
  grow_plane(state, plane, candidate);
  claim_points(state, candidate, plane);
  ++state.counts.merges;
}

void conquer(SegmentState& state, const Candidate& candidate) {
  std::vector<Pair> pairs;
  const PairVisitor remember = [&](const Pair& pair) { pairs.push_back(pair); };
  const std::int32_t partner = choose_partner(state, candidate, state.trace ? &remember : nullptr);
  if (state.trace) trace_ratios(state, pairs, partner);
  if (partner >= 0)
    merge(state, candidate, partner);
  else
    found(state, candidate, Stage::merge);
}

// ---- Sec. IV-C, last paragraph: assigning leftover points to planes ----

PlaneChoice choose_plane(const SegmentState& state, std::uint32_t i, const PointVisitor* visitor) {
  PlaneChoice choice;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    if (!state.planes[k].alive) continue;
    const PointTerms terms{k, std::abs(state.planes[k].fit.distance_m(state.point(i))),
                           state.options.leftover_distance_m};
    if (visitor) (*visitor)(terms);
    if (terms.passes()) return {k, terms.distance_m};
    if (choice.distance_m < 0 || terms.distance_m < choice.distance_m)
      choice.distance_m = terms.distance_m;
  }
  return choice;
}

void assign_leftovers(SegmentState& state) {
  state.counts.leftovers = static_cast<std::uint32_t>(state.leftovers.size());
  for (const std::uint32_t i : state.leftovers) {
    const PlaneChoice choice = choose_plane(state, i);
    const bool found = choice.plane >= 0;
    log(state, {.type = found ? EventType::assign : EventType::drop,
                .stage = Stage::assign,
                .plane = choice.plane,
                .point = state.input_index(i),
                .value = static_cast<float>(choice.distance_m)});
    if (!found) continue;  // it remains a leftover
    ++state.counts.assigned;
    give_point(state, i, choice.plane);
  }
}

}  // namespace planescope::planes
