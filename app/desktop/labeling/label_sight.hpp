#pragma once

// What a view in space shows of the points that are labelled, for strokes and clicks in it.

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// The frame's points in a view of that size, through the camera in force. Kept in the state until
/// the camera, the size, the frame or what is hidden changes. The frame and its labels are there.
const labels::SeenPoints& sight(State& state, int width, int height);

/// The point that is seen at a place, as its pixel; -1 where there is none nearby.
std::int64_t pixel_seen_at(const labels::SeenPoints& seen, const labels::Vec2f& place);

/// On which side of a line on the view each pixel's point lies, as split_by_side() takes it.
std::vector<float> sides_in_space(
    const State& state, int width, int height, const labels::Vec2f& from, const labels::Vec2f& to);

}  // namespace planescope::desktop
