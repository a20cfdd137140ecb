#pragma once

// A map seen from above.

#include "core/model/image.hpp"
#include "core/world/map_recording.hpp"

namespace planescope::app {

/// The planes of one segment in the colours of their tracks, x of its world to the right and y
/// upwards: what is highest shows, upright planes as dark lines, what is gone hatched. The camera's
/// way and a scale. Empty where the segment has no planes.
Image8 map_from_above(const world::WorldMap& map, int segment);

}  // namespace planescope::app
