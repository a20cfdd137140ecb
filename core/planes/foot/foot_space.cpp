#include "core/planes/foot/foot_space.hpp"

#include <cmath>
#include <numbers>

#include "core/planes/foot/convex_pieces.hpp"

namespace planescope::planes {
namespace {

/// Few corners make few pieces: the area is inset by this more, and simplified by as much.
constexpr double kCorners_m = 0.005;

/// With the unknown holes that are too large to be stepped over.
Polygons ground_of(const Outline& outline, double least_hole_m2) {
  Polygons ground;
  for (const Outline::Part& part : outline.parts) {
    Polygon& polygon = ground.emplace_back(Polygon{part.outer, part.holes});
    for (const PolygonRing& hole : part.unknown)
      if (-polygon_area(hole) >= least_hole_m2) polygon.holes.push_back(hole);
  }
  return ground;
}

}  // namespace

FootSpace foot_space(const Outline& outline, const Places& places, const FootOptions& options) {
  const double foot_m2 = std::numbers::pi * options.radius_m * options.radius_m;
  const double inset_m = options.radius_m + options.margin_m + kCorners_m;
  FootSpace space;
  const Polygons exact =
      without(inset(ground_of(outline, options.unknown_share * foot_m2), inset_m),
              places.near_off(options.max_off_m, inset_m));
  space.area = simplified(exact, kCorners_m);
  if (!is_valid(space.area)) space.area = exact;
  space.area_m2 = area(space.area);
  space.pieces = convex_pieces(space.area);
  return space;
}

}  // namespace planescope::planes
