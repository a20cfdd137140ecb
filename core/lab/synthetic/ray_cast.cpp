#include "core/lab/synthetic/ray_cast.hpp"

#include <limits>

namespace planescope::lab {
namespace {

// Rays at a seam of two polygons hit one of them in spite of rounding.
constexpr double kSeamM = 1e-9;

bool is_inside(const CastScene& scene, const CastScene::Polygon& polygon, const Vec3d& point) {
  for (int i = 0; i < polygon.edge_count; ++i) {
    const CastScene::HalfSpace& edge = scene.edges[polygon.first_edge + i];
    if (edge.normal.dot(point) < edge.offset - kSeamM) return false;
  }
  return true;
}

/// Parameter of the crossing with the polygon's plane; negative where there is none.
double crossing(const CastScene::HalfSpace& plane, const Vec3d& origin, const Vec3d& direction) {
  const double approach = plane.normal.dot(direction);
  if (approach == 0) return -1;
  return (plane.offset - plane.normal.dot(origin)) / approach;
}

}  // namespace

CastScene make_cast_scene(const Scene& scene) {
  CastScene cast;
  for (const Surface& surface : scene.surfaces) {
    const auto& corners = surface.corners;
    CastScene::Polygon polygon;
    polygon.plane = {surface.normal, surface.normal.dot(corners[0])};
    polygon.first_edge = static_cast<int>(cast.edges.size());
    polygon.edge_count = static_cast<int>(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3d along = corners[(i + 1) % corners.size()] - corners[i];
      const Vec3d inward = surface.normal.cross(along).normalized();
      cast.edges.push_back({inward, inward.dot(corners[i])});
    }
    cast.polygons.push_back(polygon);
  }
  return cast;
}

Hit first_hit(const CastScene& scene, const Vec3d& origin, const Vec3d& direction) {
  Hit hit;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scene.polygons.size(); ++i) {
    const double t = crossing(scene.polygons[i].plane, origin, direction);
    if (t <= 0 || t >= nearest) continue;
    if (!is_inside(scene, scene.polygons[i], origin + t * direction)) continue;
    nearest = t;
    hit = {static_cast<int>(i), t};
  }
  return hit;
}

bool is_blocked(const CastScene& scene, const Vec3d& from, const Vec3d& to) {
  constexpr double kEnd = 1e-6;
  const Vec3d direction = to - from;
  for (const CastScene::Polygon& polygon : scene.polygons) {
    const double t = crossing(polygon.plane, from, direction);
    if (t > kEnd && t < 1 - kEnd && is_inside(scene, polygon, from + t * direction)) return true;
  }
  return false;
}

}  // namespace planescope::lab
