#pragma once

// What a plane is like to stand on.

#include <vector>

#include "core/planes/foot/places.hpp"
#include "core/planes/outline/outline.hpp"

namespace planescope::planes {

struct Surface {
  double slope_deg = 0;     // against the horizontal; NaN: gravity is not known
  double rough_rms_m = 0;   // of how high its places are above the mean of those within 5 cm
  double rough_step_m = 0;  // 95th percentile of the steps between neighbouring places
  double support = 0;       // pixels on it, of those within its outline that see nothing else; of
                            // clouds, and where rays graze it, places; 0..1
  Vec3d best_place = Vec3d::Zero();  // farthest from the outline's borders and holes; world [m]
  double clearance_m = 0;            // how far
};

/// One for each plane, by id - 1; `outlines` and `places` likewise.
std::vector<Surface> surfaces_of(const Frame& frame,
                                 const FrameResult& result,
                                 const std::vector<Outline>& outlines,
                                 const std::vector<Places>& places);

}  // namespace planescope::planes
