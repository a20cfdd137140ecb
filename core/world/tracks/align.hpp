#pragma once

// Aligns a frame with the tracks before matching. Poses err by a centimeter and half a degree, more
// in fast turns; uncorrected, planes match the wrong track.

#include <span>

#include "core/world/tracks/observation.hpp"
#include "core/world/tracks/track.hpp"

namespace planescope::world {

/// T_world_camera of the frame, moved so that its depth fits the tracks (point to plane, the given
/// pose with its uncertainty as a prior). As given where the depth fits within its noise.
Pose aligned_pose(const ObservedFrame& frame, std::span<Track* const> tracks);

/// The same observation at another pose.
void move_to(ObservedFrame& frame, const Pose& T_world_camera);

}  // namespace planescope::world
