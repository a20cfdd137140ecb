#pragma once

#include <span>
#include <vector>

#include "core/lab/synthetic/scene.hpp"

namespace planescope::lab {

/// A scene's polygons as half-spaces: exact ray casting, quick enough for some dozens of them.
struct CastScene {
  struct HalfSpace {
    Vec3d normal;  // inside: normal . x >= offset
    double offset = 0;
  };
  struct Polygon {
    HalfSpace plane;
    int first_edge = 0, edge_count = 0;
  };
  std::vector<Polygon> polygons;  // by index in Scene::surfaces
  std::vector<HalfSpace> edges;
};

CastScene make_cast_scene(const Scene& scene);

struct Hit {
  int surface = -1;  // index in Scene::surfaces; -1: nothing
  double t = 0;      // origin + t * direction
};

/// The nearest surface with t > 0.
Hit first_hit(const CastScene& scene, const Vec3d& origin, const Vec3d& direction);

/// Whether something stands strictly between two points; `from` may lie on a surface.
bool is_blocked(const CastScene& scene, const Vec3d& from, const Vec3d& to);

}  // namespace planescope::lab
