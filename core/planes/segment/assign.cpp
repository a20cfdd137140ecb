// Sun et al. 2023, Sec. IV-C, last paragraph: points left over by the traversal go to planes.

#include <cmath>

#include "core/planes/segment/choices.hpp"

namespace planescope::planes {

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
    if (!found) continue;  // it stays left over
    ++state.counts.assigned;
    give_point(state, i, choice.plane);
  }
}

}  // namespace planescope::planes
