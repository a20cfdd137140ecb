#pragma once

// Where the centre of a foot may go on a plane.

#include <vector>

#include "core/planes/foot/options.hpp"
#include "core/planes/foot/places.hpp"
#include "core/planes/outline/outline.hpp"

namespace planescope::planes {

struct FootSpace {
  Polygons area;  // of the foot's centre, on the plane as the outline has it; valid
  double area_m2 = 0;
  std::vector<PolygonRing> pieces;  // convex_pieces() of it
};

/// The outline without what is not flat, inset by the foot's radius and margin. Holes where
/// something else was seen are kept off however small: what was seen there is an obstacle. Of those
/// where nothing was, small ones are stepped over.
FootSpace foot_space(const Outline& outline, const Places& places, const FootOptions& options);

}  // namespace planescope::planes
