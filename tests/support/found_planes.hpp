#pragma once

// Scenes to test every rival on, and checks of its result.

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/model/random.hpp"
#include "core/planes/rivals/rivals.hpp"

namespace planescope::test {

/// A floor at z = 0 and a wall at x = 0.6 m; `noise_m` is perpendicular to both.
inline std::vector<Vec3f> floor_and_wall(int floor_points, int wall_points, double noise_m = 0) {
  Random random(7);
  std::vector<Vec3f> points;
  for (int i = 0; i < floor_points; ++i) {
    points.push_back(
        Vec3d(random.uniform(0, 0.6), random.uniform(0, 0.6), noise_m * random.normal())
            .cast<float>());
  }
  for (int i = 0; i < wall_points; ++i) {
    points.push_back(
        Vec3d(0.6 + noise_m * random.normal(), random.uniform(0, 0.6), random.uniform(0, 0.4))
            .cast<float>());
  }
  return points;
}

inline std::vector<Vec3f> points_everywhere(int count) {
  Random random(11);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    points.push_back(
        Vec3d(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)).cast<float>());
  }
  return points;
}

inline double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::min(1.0, std::abs(a.dot(b)))) * 57.29577951308232;
}

inline bool same(const planes::FoundPlanes& a, const planes::FoundPlanes& b) {
  const auto same_fit = [](const PlaneFit& p, const PlaneFit& q) {
    return p.count == q.count && p.normal == q.normal && p.centroid == q.centroid &&
           p.eigenvalues == q.eigenvalues;
  };
  return a.plane_of == b.plane_of && std::ranges::equal(a.planes, b.planes, same_fit);
}

}  // namespace planescope::test
