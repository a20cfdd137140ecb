#pragma once

// Small clouds with known planes.

#include <cmath>
#include <functional>

#include "core/labels/model/grid.hpp"
#include "core/model/frame.hpp"
#include "core/model/random.hpp"

namespace planescope::test {

/// A cloud with the true plane of each point.
struct TrueCloud {
  Frame frame;
  std::vector<int> plane_of;  // from 1
  labels::LabelGrid grid;

  labels::PixelSet on(int plane) const {
    labels::PixelSet points;
    for (std::uint32_t i = 0; i < plane_of.size(); ++i)
      if (plane_of[i] == plane) points.push_back(i);
    return points;
  }
  /// The point nearest to a position.
  std::uint32_t at(const Vec3f& place) const {
    std::uint32_t nearest = 0;
    for (std::uint32_t i = 0; i < grid.pixels(); ++i)
      if ((grid.points[i] - place).norm() < (grid.points[nearest] - place).norm()) nearest = i;
    return nearest;
  }
};

inline Gravity down() {
  Gravity gravity;
  gravity.direction = Vec3d(0, 0, -1);
  return gravity;
}

/// A floor and two steps of 1 m width, 0.3 m depth and 0.2 m height, with points every 2 cm: floor
/// 1, risers 2 and 4, treads 3 and 5. `noise_m` is uniform; `hole`: a region without points.
inline TrueCloud stair_cloud(double noise_m = 0.001,
                             const std::function<bool(const Vec3f&)>& hole = {}) {
  TrueCloud cloud;
  cloud.frame.name = "stairs";
  PointSet set;
  Random random(7);
  const auto sheet = [&](int plane, const Vec3f& corner, const Vec3f& across, const Vec3f& along) {
    const Vec3f normal = across.cross(along).normalized();
    constexpr float kStep = 0.02f;
    for (float a = kStep / 2; a < across.norm(); a += kStep)
      for (float b = kStep / 2; b < along.norm(); b += kStep) {
        const Vec3f exact = corner + a * across.normalized() + b * along.normalized();
        if (hole && hole(exact)) continue;
        const auto noise = static_cast<float>(noise_m * (2 * random.uniform() - 1));
        set.points.push_back(exact + noise * normal);
        cloud.plane_of.push_back(plane);
      }
  };
  sheet(1, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  sheet(2, {0, 1, 0}, {1, 0, 0}, {0, 0, 0.2f});
  sheet(3, {0, 1, 0.2f}, {1, 0, 0}, {0, 0.3f, 0});
  sheet(4, {0, 1.3f, 0.2f}, {1, 0, 0}, {0, 0, 0.2f});
  sheet(5, {0, 1.3f, 0.4f}, {1, 0, 0}, {0, 0.3f, 0});
  cloud.frame.depth_unit_m = 1;
  cloud.frame.cloud = std::move(set);
  cloud.grid = labels::make_label_grid(cloud.frame, down());
  return cloud;
}

}  // namespace planescope::test
