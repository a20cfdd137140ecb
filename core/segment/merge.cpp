// Sun et al. 2023, Sec. IV-C (Criterion 4) and IV-D (incremental merge); R1, R3 and R7.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/segment/cells.hpp"
#include "core/segment/state.hpp"

namespace planescope {
namespace {

struct Partner {
  std::int32_t plane = -1;
  double cost = 0;
};

/// The plane that a candidate came nearest to joining, for the trace.
class NearestMiss {
 public:
  void consider(const PairStrain& strain) {
    if (strain.worst < nearest_.worst) nearest_ = strain;
  }
  /// `joined`: what the candidate joined instead.
  void log(Trace* trace, const std::optional<PairStrain>& joined) const {
    const PairStrain& strain = joined ? *joined : nearest_;
    if (!trace || std::isinf(strain.worst)) return;
    trace->strains.angle.push_back(static_cast<float>(strain.angle));
    trace->strains.distance.push_back(static_cast<float>(strain.distance));
  }

 private:
  PairStrain nearest_{0, 0, std::numeric_limits<double>::infinity()};
};

/// Criterion 4 against the planes in the order of the list: the first that is coplanar, or (option)
/// the one with the least offset.
Partner partner_by_direction(const SegmentState& state, const Candidate& candidate) {
  Partner best;
  NearestMiss miss;
  std::optional<PairStrain> joined;
  for (std::size_t k = 0; k < state.planes.size(); ++k) {
    if (!state.planes[k].alive) continue;
    const Coplanarity terms = coplanarity(state.planes[k].fit, candidate.fit);
    if (!is_coplanar(terms, state.options)) {
      if (state.trace) miss.consider(strain_of(terms, state.options));
      continue;
    }
    if (best.plane < 0 || terms.offset_m < best.cost) {
      best = {static_cast<std::int32_t>(k), terms.offset_m};
      if (state.trace) joined = strain_of(terms, state.options);
    }
    if (state.options.merge_partner == MergePartner::first) break;
  }
  miss.log(state.trace, joined);
  return best;
}

/// R1: the plane of the same label that the candidate fits best.
Partner partner_by_distance(const SegmentState& state, const Candidate& candidate) {
  Partner best;
  NearestMiss miss;
  std::optional<PairStrain> joined;
  const MeasuredPlane measured = state.measured(candidate);
  for (std::size_t k = 0; k < state.planes.size(); ++k) {
    const GrowingPlane& plane = state.planes[k];
    if (!plane.alive || plane.label != candidate.label) continue;
    const DistanceTerms terms = distance_terms(state.measured(plane), measured);
    if (!terms.passes()) {
      if (state.trace) miss.consider(strain_of(terms));
      continue;
    }
    if (best.plane < 0 || terms.cost() < best.cost) {
      best = {static_cast<std::int32_t>(k), terms.cost()};
      if (state.trace) joined = strain_of(terms);
      if (state.options.merge_partner == MergePartner::first) break;
    }
  }
  miss.log(state.trace, joined);
  return best;
}

void claim_points(SegmentState& state, const Candidate& candidate, std::int32_t plane) {
  const OctreeNode& node = state.octree.nodes[candidate.node];
  for (std::uint32_t i = node.begin; i < node.end; ++i)
    if (has_label(state, i, candidate.label)) state.plane_of[i] = plane;
}

/// Eq. (6)-(9): moments add, PCA follows from them.
template <typename PlaneOrCandidate>
void grow(SegmentState& state, GrowingPlane& plane, const PlaneOrCandidate& part) {
  plane.moments += part.moments;
  plane.bounds += part.bounds;
  plane.fit = fit_plane(plane.moments);
  plane.sigma_ang =
      normal_uncertainty(plane.fit, state.noise.sigma(state.range(plane.fit.centroid)));
}

void found(SegmentState& state, const Candidate& candidate, std::uint8_t refinement) {
  const auto plane = static_cast<std::int32_t>(state.planes.size());
  state.log({.type = EventType::found,
             .refinement = refinement,
             .label = candidate.label,
             .node = candidate.node,
             .plane = plane});
  state.planes.push_back(
      {candidate.label, candidate.moments, candidate.fit, candidate.sigma_ang, candidate.bounds});
  claim_points(state, candidate, plane);
}

void merge(SegmentState& state,
           const Candidate& candidate,
           std::int32_t plane,
           std::uint8_t refinement) {
  const double offset = state.planes[plane].fit.distance_m(candidate.fit.centroid);
  state.log({.type = EventType::merge,
             .refinement = refinement,
             .label = candidate.label,
             .node = candidate.node,
             .plane = plane,
             .value = static_cast<float>(std::abs(offset))});
  grow(state, state.planes[plane], candidate);
  claim_points(state, candidate, plane);
  ++state.counts.merges;
}

}  // namespace

void conquer(SegmentState& state, const Candidate& candidate) {
  const bool r1 = state.options.r1_merge_by_distance;
  const Partner partner =
      r1 ? partner_by_distance(state, candidate) : partner_by_direction(state, candidate);
  const std::uint8_t refinement = r1 ? 1 : 0;
  if (partner.plane >= 0)
    merge(state, candidate, partner.plane, refinement);
  else
    found(state, candidate, refinement);
}

void join_weak_candidates(SegmentState& state) {
  if (state.weak.empty()) return;
  const CellGrid grid = make_cell_grid(state.octree);
  const CellPlanes near = planes_near_cells(grid, state.plane_of, state.planes.size());
  const std::size_t strong = state.planes.size();

  for (const Candidate& candidate : state.weak) {
    const MeasuredPlane measured = state.measured(candidate);
    Partner best;
    const auto consider = [&](std::int32_t k, bool by_distance_only) {
      const GrowingPlane& plane = state.planes[k];
      if (plane.label != candidate.label) return;
      DistanceTerms terms = distance_terms(state.measured(plane), measured);
      if (by_distance_only) terms.max_angle_deg = 180;
      if (terms.passes() && (best.plane < 0 || terms.cost() < best.cost)) best = {k, terms.cost()};
    };
    const OctreeNode& node = state.octree.nodes[candidate.node];
    std::optional<std::uint32_t> last_cell;  // points of a cell stand side by side
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      if (!has_label(state, i, candidate.label) || grid.cell_of[i] == last_cell) continue;
      last_cell = grid.cell_of[i];
      for (const std::int32_t k : near.near(*last_cell)) consider(k, true);
    }
    for (std::size_t k = strong; k < state.planes.size(); ++k)
      consider(static_cast<std::int32_t>(k), false);
    if (best.plane >= 0) {
      merge(state, candidate, best.plane, 3);
    } else if (candidate.fit.count >= kMinWeakPoints && candidate.sigma_ang <= kMaxWeakSigmaAng) {
      found(state, candidate, 3);
    } else {
      state.log({.type = EventType::leave,
                 .refinement = 3,
                 .label = candidate.label,
                 .node = candidate.node,
                 .value = static_cast<float>(candidate.sigma_ang)});
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        if (has_label(state, i, candidate.label)) state.leftovers.push_back(i);
    }
  }
}

void merge_planes_again(SegmentState& state) {
  // R7: small into large, until nothing changes. Founding order let early candidates, whose normals
  // were still poor, stay apart.
  std::vector<std::int32_t> by_size(state.planes.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  bool any = false;
  for (bool changed = true; changed;) {
    changed = false;
    std::stable_sort(by_size.begin(), by_size.end(), [&](std::int32_t a, std::int32_t b) {
      return state.planes[a].moments.count < state.planes[b].moments.count;
    });
    for (std::size_t i = 0; i < by_size.size() && !changed; ++i) {
      GrowingPlane& small = state.planes[by_size[i]];
      if (!small.alive) continue;
      const MeasuredPlane measured = state.measured(small);
      Partner best;
      for (std::size_t j = i + 1; j < by_size.size(); ++j) {
        const GrowingPlane& large = state.planes[by_size[j]];
        if (!large.alive || large.label != small.label) continue;
        const DistanceTerms terms = distance_terms(state.measured(large), measured);
        if (terms.passes() && (best.plane < 0 || terms.cost() < best.cost))
          best = {by_size[j], terms.cost()};
      }
      if (best.plane < 0) continue;
      state.log(
          {.type = EventType::refine, .refinement = 7, .plane = by_size[i], .other = best.plane});
      grow(state, state.planes[best.plane], small);
      small.alive = false;
      small.into = best.plane;
      any = changed = true;
    }
  }
  if (!any) return;
  for (std::int32_t& plane : state.plane_of)
    while (plane >= 0 && state.planes[plane].into >= 0) plane = state.planes[plane].into;
}

}  // namespace planescope
