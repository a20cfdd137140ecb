#pragma once

// Polygons with holes on a plane, by GEOS. Rings are not closed by a repeated point; outer rings
// are counter-clockwise, holes clockwise. Valid are those whose rings do not cross themselves or
// each other; united() and common() want such, and give such.

#include <array>
#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::planes {

using PolygonRing = std::vector<Vec2d>;  // [m]

struct Polygon {
  PolygonRing outer;
  std::vector<PolygonRing> holes;
};
using Polygons = std::vector<Polygon>;  // that do not overlap

/// Without the holes [m^2]; rings turn as said above.
double area(const Polygon& polygon);
double area(std::span<const Polygon> polygons);

/// With fewer corners, and no point of a ring farther than this from it [m]. Of valid polygons the
/// result mostly is valid, but not always.
Polygons simplified(const Polygons& polygons, double tolerance_m);
/// Valid polygons of about the same area, where rings cross.
Polygons repaired(const Polygon& polygon);
// Corners to a nanometre:
Polygons united(const Polygons& a, const Polygons& b);
Polygons common(const Polygons& a, const Polygons& b);
Polygons without(const Polygons& a, const Polygons& b);

/// What of valid polygons is farther than this from everything outside of them and from their
/// holes: valid, and mostly of as many corners.
Polygons inset(const Polygons& polygons, double distance_m);

/// Of valid polygons; counter-clockwise, with the polygons' corners and no others.
using Triangle = std::array<Vec2d, 3>;
std::vector<Triangle> triangulated(const Polygons& polygons);

/// The largest circle in them, its centre found to the tolerance. Radius 0: they have no area.
struct Circle {
  Vec2d centre = Vec2d::Zero();
  double radius_m = 0;
};
Circle largest_circle(const Polygons& polygons, double tolerance_m);

bool is_valid(const Polygons& polygons);
/// By the rule of even and odd.
bool is_in(const PolygonRing& ring, const Vec2d& p);

/// Of valid polygons: convex, counter-clockwise, inside, apart from each other but for their edges,
/// the largest first; together they have `least_share` of the area, in few pieces. From a
/// constrained Delaunay triangulation: neighbours are joined, where need be with what stands in the
/// way of a convex piece cut off, and slivers are dropped, whatever costs the least area first.
std::vector<PolygonRing> convex_pieces(const Polygons& polygons, double least_share = 0.95);

}  // namespace planescope::planes
