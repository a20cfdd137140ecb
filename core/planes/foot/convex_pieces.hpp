#pragma once

// Convex pieces of polygons, as planners take them.

#include <vector>

#include "core/planes/outline/polygons.hpp"

namespace planescope::planes {

/// Of valid polygons: convex, counter-clockwise, inside, apart from each other but for their edges,
/// the largest first; together they have `least_share` of the area, in few pieces. From a
/// constrained Delaunay triangulation: neighbours are joined, where need be with what stands in the
/// way of a convex piece cut off, and slivers are dropped, whatever costs the least area first.
std::vector<PolygonRing> convex_pieces(const Polygons& polygons, double least_share = 0.95);

}  // namespace planescope::planes
