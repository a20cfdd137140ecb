#pragma once

#include <span>
#include <vector>

#include "core/model/types.hpp"

namespace planescope {

/// Two unit vectors u, v with u x v = normal, chosen from the normal alone.
struct PlaneBasis {
  Vec3d u;
  Vec3d v;
};
PlaneBasis plane_basis(const Vec3d& normal);

/// Convex hull, counter-clockwise, without collinear points. Fewer than 3 distinct points: those.
std::vector<Vec2d> convex_hull(std::vector<Vec2d> points);

/// Area of a simple polygon [m^2], positive when counter-clockwise.
double polygon_area(std::span<const Vec2d> polygon);

}  // namespace planescope
