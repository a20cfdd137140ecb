#pragma once

// Labels from the map: what a frame measures of a track.

#include "core/labels/model/grid.hpp"
#include "core/world/tracks/track.hpp"

namespace planescope::world {

struct PixelsOfTrack {
  labels::PixelSet sure;
  labels::PixelSet doubtful;  // at its place, and farther off than noise alone puts them, or at
                              // another angle
};

/// Of a depth image at this pose in the track's world.
PixelsOfTrack pixels_of_track(const Track& track,
                              const labels::LabelGrid& grid,
                              const Pose& T_world_camera);

}  // namespace planescope::world
