#pragma once

// What a frame shows at the place of a plane that is known.

#include <vector>

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

}  // namespace planescope::world
