#pragma once

// Pictures of a map from above.

#include <vector>

#include "core/model/types.hpp"
#include "core/world/map_recording.hpp"

namespace planescope::app {

/// Color ids of tracks, by track id - 1. Tracks that touch in the world get different colors; two
/// that are visible in the same frame share a color as rarely as possible.
std::vector<int> colors_of_tracks(const world::Tracker& tracker);

/// Draws the planes of one segment in the colors of their tracks, with world x to the right and y
/// up. The highest plane is on top, vertical planes are lines, and planes in state `gone` are
/// hatched. Includes the camera path and a scale. Empty if the segment has no planes.
Image8 map_from_above(const world::WorldMap& map, int segment);

}  // namespace planescope::app
