#pragma once

// A map seen from above.

#include <vector>

#include "core/model/types.hpp"
#include "core/world/map_recording.hpp"

namespace planescope::app {

/// Color ids of tracks, by track id - 1. Tracks that touch in the world have different colors;
/// beyond that, two that are seen in the same frames share one as rarely as possible.
std::vector<int> colors_of_tracks(const world::Tracker& tracker);

/// The planes of one segment in the colors of their tracks, x of its world to the right and y
/// upwards: what is highest shows, upright planes as lines, what is gone hatched. The camera's way
/// and a scale. Empty where the segment has no planes.
Image8 map_from_above(const world::WorldMap& map, int segment);

}  // namespace planescope::app
