#pragma once

// What a map expects a frame to show.

#include <span>
#include <vector>

#include "core/planes/depth/inverse_depth.hpp"
#include "core/world/tracks/track.hpp"

namespace planescope::world {

/// The tracks as candidates for the planes of a frame at this pose; `KnownPlane::id` is the
/// track's. Of each, the measured pixels whose rays hit cells that are sure or gone.
std::vector<planes::KnownPlane> expected_planes(std::span<const Track* const> tracks,
                                                const Frame& frame,
                                                const Pose& T_world_camera,
                                                const TrackOptions& options,
                                                int threads = 1);

}  // namespace planescope::world
