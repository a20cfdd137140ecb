// Sun et al. 2023, Sec. IV-C (Criterion 4) and IV-D (incremental merge).

#include <algorithm>
#include <cmath>

#include "core/planes/segment/choices.hpp"

namespace planescope::planes {
namespace {

void claim_points(SegmentState& state, const Candidate& candidate, std::int32_t plane) {
  const OctreeNode& node = state.octree.nodes[candidate.node];
  for (std::uint32_t i = node.begin; i < node.end; ++i)
    if (state.has_label(i, candidate.label)) give_point(state, i, plane);
}

/// Of the pair that was chosen or, where none was, of the one that came nearest.
void trace_strain(const SegmentState& state, const std::vector<Pair>& pairs, std::int32_t chosen) {
  const auto joined = std::ranges::find(pairs, chosen, &Pair::plane);
  const Pair* shown = joined != pairs.end() ? &*joined : nearest_pair(pairs, state.options);
  if (!shown) return;
  const PairStrain strain = strain_of(*shown, state.options);
  if (std::isinf(strain.worst)) return;
  state.trace->strains.angle.push_back(static_cast<float>(strain.angle));
  state.trace->strains.distance.push_back(static_cast<float>(strain.distance));
}

}  // namespace

PairStrain strain_of(const Pair& pair, const SegmentOptions& options) {
  if (const auto* terms = std::get_if<DistanceTerms>(&pair.terms)) return strain_of(*terms);
  return strain_of(std::get<Coplanarity>(pair.terms), options);
}

const Pair* nearest_pair(std::span<const Pair> pairs, const SegmentOptions& options) {
  const Pair* nearest = nullptr;
  double least = INFINITY;
  for (const Pair& pair : pairs)
    if (const double worst = strain_of(pair, options).worst; worst < least) {
      nearest = &pair;
      least = worst;
    }
  return nearest;
}

Pair pair_by_distance(const SegmentState& state,
                      std::int32_t k,
                      const MeasuredPlane& measured,
                      bool any_angle) {
  DistanceTerms terms =
      distance_terms(state.measured(state.planes[k]), measured, state.options.r1_merge_by_distance);
  terms.any_angle = any_angle;
  return {k, terms, terms.passes(), terms.cost()};
}

bool is_out_of_reach(const SegmentState& state, std::int32_t k, const MeasuredPlane& measured) {
  return are_out_of_reach(state.measured(state.planes[k]), measured,
                          state.options.r1_merge_by_distance);
}

std::optional<Pair> compare(const SegmentState& state,
                            std::int32_t k,
                            const Candidate& candidate,
                            const MeasuredPlane& measured) {
  const GrowingPlane& plane = state.planes[k];
  const SegmentOptions& options = state.options;
  if (!plane.alive) return {};
  if (!options.r1_merge_by_distance.on) {
    const Coplanarity terms = coplanarity(plane.fit, candidate.fit);
    return Pair{k, terms, is_coplanar(terms, options), terms.offset_m};
  }
  if (plane.label != candidate.label) return {};
  return pair_by_distance(state, k, measured);
}

std::int32_t choose_partner(const SegmentState& state,
                            const Candidate& candidate,
                            const PairVisitor* visitor) {
  const MeasuredPlane measured = state.measured(candidate);
  CheapestPair best{visitor};
  const bool skips = !visitor && state.options.r1_merge_by_distance.on;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    if (skips && is_out_of_reach(state, k, measured)) continue;
    if (const std::optional<Pair> pair = compare(state, k, candidate, measured))
      best.consider(*pair);
    if (best.plane >= 0 && state.options.merge_partner == MergePartner::first) break;
  }
  return best.plane;
}

void found(SegmentState& state, const Candidate& candidate, Stage stage) {
  log(state, {.type = EventType::found,
              .stage = stage,
              .label = candidate.label,
              .node = candidate.node,
              .plane = static_cast<std::int32_t>(state.planes.size())});
  const std::int32_t plane = found_plane(state, {.label = candidate.label,
                                                 .moments = candidate.moments,
                                                 .fit = candidate.fit,
                                                 .sigma_ang = candidate.sigma_ang,
                                                 .bounds = candidate.bounds});
  claim_points(state, candidate, plane);
}

void merge(SegmentState& state, const Candidate& candidate, std::int32_t plane, Stage stage) {
  const double offset = state.planes[plane].fit.distance_m(candidate.fit.centroid);
  log(state, {.type = EventType::merge,
              .stage = stage,
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
  if (state.trace) trace_strain(state, pairs, partner);
  const Stage stage =
      state.options.r1_merge_by_distance.on ? Stage::r1_merge_by_distance : Stage::merge;
  if (partner >= 0)
    merge(state, candidate, partner, stage);
  else
    found(state, candidate, stage);
}

}  // namespace planescope::planes
