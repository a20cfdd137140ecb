#pragma once

// Planes that are known from other frames, as candidates for this one.

#include <cstdint>
#include <vector>

#include "core/planes/depth/inverse_depth.hpp"

namespace planescope::planes {

/// A plane as it is expected in a depth image.
struct KnownPlane {
  int id = 0;  // PlaneRegion::known of the plane it becomes
  InversePlane plane;
  std::vector<std::uint32_t> pixels;  // that should show it
  double slack_m = 0;                 // along z: the expectation may be off by this much
};

/// A known plane that a larger one explains as well in this image. Ids.
struct KnownCover {
  int covered = 0, by = 0;
};

}  // namespace planescope::planes
