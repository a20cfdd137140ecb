#include "core/model/hull.hpp"

#include <algorithm>
#include <cmath>

namespace planescope {
namespace {

double cross(const Vec2d& o, const Vec2d& a, const Vec2d& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

}  // namespace

PlaneBasis plane_basis(const Vec3d& normal) {
  // The world axis farthest from the normal, so that the basis does not turn with small changes.
  const Vec3d axis = std::abs(normal.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX();
  PlaneBasis basis;
  basis.u = axis.cross(normal).normalized();
  basis.v = normal.cross(basis.u);
  return basis;
}

std::vector<Vec2d> convex_hull(std::vector<Vec2d> points) {
  // Andrew's monotone chain.
  std::sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2d> hull;
  const auto extend = [&](const Vec2d& p, std::size_t keep) {
    while (hull.size() >= keep + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0)
      hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec2d& p : points) extend(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto it = points.rbegin() + 1; it != points.rend(); ++it) extend(*it, lower);
  hull.pop_back();
  return hull;
}

double polygon_area(std::span<const Vec2d> polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d& a = polygon[i];
    const Vec2d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

}  // namespace planescope
