#pragma once

// Random polygons with holes, and properties of convex pieces.

#include <algorithm>
#include <cmath>

#include "core/model/plane.hpp"
#include "core/model/random.hpp"
#include "core/planes/outline/polygons.hpp"

namespace planescope::test {

/// A star around `center`: valid, usually not convex.
inline planes::PolygonRing random_star(
    Random& random, const Vec2d& center, double least_m, double most_m, int corners) {
  planes::PolygonRing ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * M_PI * (i + random.uniform(0, 0.8)) / corners;
    ring.push_back(center +
                   random.uniform(least_m, most_m) * Vec2d(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

/// About 1 m wide, with up to four holes, which may touch the border but not each other.
inline planes::Polygons random_polygons(Random& random) {
  planes::Polygons polygons = {
      {random_star(random, Vec2d::Zero(), 0.25, 0.55, random.integer(3, 24)), {}}};
  const Vec2d places[] = {{-0.15, -0.15}, {0.15, -0.15}, {0.15, 0.15}, {-0.15, 0.15}};
  for (int h = random.integer(0, 4); h > 0; --h)
    polygons = planes::without(
        polygons, {{random_star(random, places[h - 1], 0.01, 0.1, random.integer(3, 9)), {}}});
  return polygons;
}

inline bool is_convex(const planes::PolygonRing& ring) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2d in = ring[(i + 1) % ring.size()] - ring[i];
    const Vec2d out = ring[(i + 2) % ring.size()] - ring[(i + 1) % ring.size()];
    if (in.x() * out.y() - in.y() * out.x() < -1e-12) return false;
  }
  return ring.size() >= 3;
}

}  // namespace planescope::test
