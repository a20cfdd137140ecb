// Sun et al. 2023, Sec. IV-C, last paragraph: points left over by the traversal go to planes.

#include <cmath>

#include "core/planes/segment/choices.hpp"

namespace planescope::planes {
namespace {

void assign(SegmentState& state, std::uint32_t i, const PlaneChoice& choice) {
  const bool found = choice.plane >= 0;
  log(state, {.type = found ? EventType::assign : EventType::drop,
              .stage = Stage::assign,
              .plane = choice.plane,
              .point = state.input_index(i),
              .value = static_cast<float>(choice.distance_m)});
  if (!found) return;  // it stays left over
  ++state.counts.assigned;
  give_point(state, i, choice.plane);
}

}  // namespace

Reach reach_of(const SegmentState& state, std::uint32_t i, LeftoverRule rule) {
  if (rule == LeftoverRule::first) return {state.options.leftover_distance_m, 0};
  return state.reach(i);
}

PointTerms point_terms(const SegmentState& state,
                       std::int32_t k,
                       std::uint32_t i,
                       const Reach& reach) {
  const GrowingPlane& plane = state.planes[k];
  return {k, std::abs(plane.fit.distance_m(state.point(i))), reach.limit_m,
          state.has_label(i, plane.label) ? 0 : reach.penalty_m};
}

PlaneChoice choose_first_plane(const SegmentState& state,
                               std::uint32_t i,
                               const PointVisitor* visitor) {
  const Reach reach = reach_of(state, i, LeftoverRule::first);
  PlaneChoice choice;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    if (!state.planes[k].alive) continue;
    const PointTerms terms = point_terms(state, k, i, reach);
    if (visitor) (*visitor)(terms);
    if (terms.passes()) return {k, terms.distance_m};
    if (choice.distance_m < 0 || terms.distance_m < choice.distance_m)
      choice.distance_m = terms.distance_m;
  }
  return choice;
}

PlaneChoice choose_nearest_plane(const SegmentState& state,
                                 std::span<const std::int32_t> near,
                                 std::uint32_t i,
                                 const PointVisitor* visitor) {
  const Reach reach = reach_of(state, i, LeftoverRule::nearest);
  PlaneChoice best;
  double least = -1;
  for (const std::int32_t k : near) {
    if (!state.planes[k].alive) continue;
    const PointTerms terms = point_terms(state, k, i, reach);
    if (visitor) (*visitor)(terms);
    const double cost = terms.distance_m + terms.penalty_m;
    if (!terms.passes() || (least >= 0 && cost >= least)) continue;
    least = cost;
    best = {k, terms.distance_m};
  }
  return best;
}

void assign_leftovers(SegmentState& state, std::size_t first) {
  state.counts.leftovers = static_cast<std::uint32_t>(state.leftovers.size());
  const auto leftovers = std::span(state.leftovers).subspan(first);
  if (state.options.leftover_rule == LeftoverRule::first) {
    for (const std::uint32_t i : leftovers) assign(state, i, choose_first_plane(state, i));
    return;
  }
  const Neighbourhood around(state);
  for (const std::uint32_t i : leftovers)
    assign(state, i, choose_nearest_plane(state, around.near(i), i));
}

}  // namespace planescope::planes
