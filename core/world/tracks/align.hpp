#pragma once

// Brings a frame to the tracks before its planes are compared with them: a given pose errs by a
// centimeter and half a degree, most of all in fast turns, and a plane must not become another one
// for it.

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
