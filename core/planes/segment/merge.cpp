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
  const PairStrain strain = strain_of(shown->terms, state.options);
  if (std::isinf(strain.worst)) return;
  state.trace->strains.angle.push_back(static_cast<float>(strain.angle));
  state.trace->strains.distance.push_back(static_cast<float>(strain.distance));
}

}  // namespace

const Pair* nearest_pair(std::span<const Pair> pairs, const SegmentOptions& options) {
  const Pair* nearest = nullptr;
  double least = INFINITY;
  for (const Pair& pair : pairs)
    if (const double worst = strain_of(pair.terms, options).worst; worst < least) {
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
  if (state.trace) trace_strain(state, pairs, partner);
  if (partner >= 0)
    merge(state, candidate, partner);
  else
    found(state, candidate, Stage::merge);
}

}  // namespace planescope::planes
