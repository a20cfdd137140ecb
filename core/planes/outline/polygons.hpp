#pragma once

// Polygons with holes on a plane, by GEOS. Rings are not closed by a repeated point; outer rings
// are counter-clockwise, holes clockwise. Valid are those whose rings do not cross themselves or
// each other; united() and common() want such, and give such.

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
Polygons united(const Polygons& a, const Polygons& b);
Polygons common(const Polygons& a, const Polygons& b);

bool is_valid(const Polygons& polygons);

}  // namespace planescope::planes
