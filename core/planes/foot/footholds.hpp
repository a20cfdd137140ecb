#pragma once

// Planes to set a foot on.

#include <optional>
#include <string>
#include <vector>

#include "core/planes/foot/certainty.hpp"
#include "core/planes/foot/foot_space.hpp"
#include "core/planes/foot/surface.hpp"

namespace planescope::planes {

struct Foothold {
  Surface surface;
  Certainty certainty;
  std::vector<Vec2d> cut;  // measured places along the first of its axes, through the centroid:
                           // how far from it, how high above the plane [m], in that order
  std::optional<FootSpace> space;  // where a foot is given, as are the following
  bool steppable = false;
  std::string why_not;  // "17 mm rough, limit 10; slope 31.0 deg, limit 25.0"; empty: steppable
};

/// One for each plane, by id - 1; `outlines` likewise.
std::vector<Foothold> footholds_of(const Frame& frame,
                                   const FrameResult& result,
                                   const std::vector<Outline>& outlines,
                                   double cell_m,
                                   const FootOptions& options);

}  // namespace planescope::planes
