#include "core/planes/segment/refine/r5_reassign_shared_cells.hpp"

#include "core/planes/segment/choices.hpp"

namespace planescope::planes::r5_reassign_shared_cells {

void run(SegmentState& state, const Options& options) {
  if (!options.on) return;
  const Neighbourhood around(state);
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i) {
    const auto near = around.near(i);
    if (state.plane_of[i] < 0 || near.size() < 2) continue;
    const PlaneChoice nearest = choose_nearest_plane(state, near, i);
    if (nearest.plane < 0 || nearest.plane == state.plane_of[i]) continue;
    log(state, {.type = EventType::refine,
                .stage = Stage::r5_reassign_shared_cells,
                .plane = state.plane_of[i],
                .other = nearest.plane,
                .point = state.input_index(i),
                .value = static_cast<float>(nearest.distance_m)});
    give_point(state, i, nearest.plane);
  }
  r2_explain_away::drop_emptied_planes(state);
}

}  // namespace planescope::planes::r5_reassign_shared_cells
