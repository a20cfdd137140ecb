#pragma once

// Tracks against a frame: what it shows at their places, its pose aligned with them, where they are
// expected in it, and which of its pixels measure them.

#include <span>
#include <vector>

#include "core/labels/model/grid.hpp"
#include "core/planes/depth/inverse_depth.hpp"
#include "core/world/tracks/observation.hpp"
#include "core/world/tracks/track.hpp"

namespace planescope::world {

/// A track's cells in a frame, by what the frame measures there. A cell in view is in one of the
/// four that follow.
struct Sight {
  int cells = 0;         // of the track
  int in_view = 0;       // within the image and the range
  int beyond_range = 0;  // within the image
  int hidden = 0;        // something stands before it
  int unmeasured = 0;
  int through = 0;  // something is measured behind it
  int there = 0;    // the measurement is on the plane

  struct On {
    int cells = 0;
    int hides = 0;              // cells that the plane stands before
    Vec3d sum = Vec3d::Zero();  // of their places in the world
  };
  struct Look {
    Cell* cell = nullptr;
    bool through = false;
  };
  std::vector<Look> looks;  // at cells in view that are measured and not hidden

  Moments places;  // of the cells that are there, about the camera

  std::vector<On> on;  // by plane id of the frame, 0 none: what is measured at the cells

  int visible() const { return through + there; }
  /// The plane on which most of it lies; 0: none.
  int most_on() const;
};

/// Looks at every present cell. Valid until the track gets cells. `there`: takes the pixels
/// v * width + u that measure it, one for each cell; may be null.
Sight sight_of(Track& track,
               const ObservedFrame& frame,
               const TrackOptions& options,
               std::vector<std::uint32_t>* there = nullptr);

/// The cells remember it; those that were seen through too often are gone.
void remember(const Sight& sight);

// ---- Alignment ----
// Aligns a frame with the tracks before matching. Poses err by a centimeter and half a degree, more
// in fast turns; uncorrected, planes match the wrong track.

/// T_world_camera of the frame, moved so that its depth fits the tracks (point to plane, the given
/// pose with its uncertainty as a prior). As given where the depth fits within its noise.
Pose aligned_pose(const ObservedFrame& frame, std::span<Track* const> tracks);

/// The same observation at another pose.
void move_to(ObservedFrame& frame, const Pose& T_world_camera);

// ---- Expected planes ----

/// The tracks as candidates for the planes of a frame at this pose; `KnownPlane::id` is the
/// track's. Of each, the measured pixels whose rays hit cells that are sure or gone.
std::vector<planes::KnownPlane> expected_planes(std::span<const Track* const> tracks,
                                                const Frame& frame,
                                                const Pose& T_world_camera,
                                                const TrackOptions& options,
                                                int threads = 1);

// ---- Labels from the map ----

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
