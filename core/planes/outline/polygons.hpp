#pragma once

// Polygons with holes in a plane, using GEOS. Rings do not repeat their first point; outer rings
// are counter-clockwise, holes clockwise. Polygons are valid if their rings cross neither
// themselves nor each other; united() and common() require and return valid polygons.

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
using Polygons = std::vector<Polygon>;  // non-overlapping

/// Area without the holes [m^2], for rings in the orientation above.
double area(const Polygon& polygon);
double area(std::span<const Polygon> polygons);

/// Removes corners, moving no point of a ring by more than the tolerance [m]. The result of valid
/// polygons is usually, but not always, valid.
Polygons simplified(const Polygons& polygons, double tolerance_m);
/// Valid polygons of about the same area, for rings that cross.
Polygons repaired(const Polygon& polygon);
// Accurate to a nanometer:
Polygons united(const Polygons& a, const Polygons& b);
Polygons common(const Polygons& a, const Polygons& b);
Polygons without(const Polygons& a, const Polygons& b);

/// The area inside valid polygons at least `distance_m` from their borders and holes. Valid,
/// usually with the same number of corners.
Polygons inset(const Polygons& polygons, double distance_m);

/// For valid polygons; counter-clockwise, using only the polygons' corners.
using Triangle = std::array<Vec2d, 3>;
std::vector<Triangle> triangulated(const Polygons& polygons);

/// Largest inscribed circle, its center accurate to the tolerance. Radius 0 if the polygons have
/// no area.
struct Circle {
  Vec2d center = Vec2d::Zero();
  double radius_m = 0;
};
Circle largest_circle(const Polygons& polygons, double tolerance_m);

bool is_valid(const Polygons& polygons);
/// Even-odd rule.
bool is_in(const PolygonRing& ring, const Vec2d& p);

/// Decomposes valid polygons into few convex, counter-clockwise pieces that do not overlap, largest
/// first, and cover `least_share` of the area. Starts from a constrained Delaunay triangulation.
/// Then it joins neighboring pieces, cutting off the parts that would make them non-convex, and
/// drops slivers; steps that lose the least area come first.
std::vector<PolygonRing> convex_pieces(const Polygons& polygons, double least_share = 0.95);

}  // namespace planescope::planes
