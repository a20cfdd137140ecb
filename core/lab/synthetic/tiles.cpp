#include "core/lab/synthetic/tiles.hpp"

#include <algorithm>

#include "core/lab/synthetic/stairs.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {

PointsOnPlanes tiles(int side, int points) {
  constexpr double kEdge_m = 5, kStep_m = 0.04, kNoise_m = 0.002;
  Random random(3);
  std::vector<double> heights(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (double& height : heights) height = kStep_m * random.integer(0, 49);
  PointsOnPlanes cloud;
  for (int i = 0; i < points; ++i) {
    const double x = random.uniform(0, side), y = random.uniform(0, side);
    const double z = heights[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                             static_cast<std::size_t>(x)];
    cloud.points.emplace_back(kEdge_m * x / side, kEdge_m * y / side,
                              z + kNoise_m * random.normal());
    cloud.labels.push_back(Label::h);
  }
  return cloud;
}

PointsOnPlanes scattered_stairs(int points) {
  constexpr double kNoise_m = 0.002;
  const Stairs stairs = make_stairs(0, {.points = 16});
  const std::vector<TruePolygon> faces = true_polygons(stairs);
  std::vector<double> area_until;
  double area = 0;
  for (const TruePolygon& face : faces) {
    const auto& c = face.corners;
    area += (c[1] - c[0]).cross(c[3] - c[0]).norm();
    area_until.push_back(area);
  }
  Random random(5);
  PointsOnPlanes cloud;
  for (int i = 0; i < points; ++i) {
    const auto at = std::ranges::lower_bound(area_until, random.uniform(0, area));
    const auto f = std::min(static_cast<std::size_t>(at - area_until.begin()), faces.size() - 1);
    const auto& c = faces[f].corners;
    const double u = random.uniform(), v = random.uniform();
    const Vec3d& normal = stairs.normals[f];
    const Vec3d p =
        c[0] + u * (c[1] - c[0]) + v * (c[3] - c[0]) + kNoise_m * random.normal() * normal;
    cloud.points.push_back(p.cast<float>());
    cloud.labels.push_back(std::abs(normal.z()) > 0.5 ? Label::h : Label::v);
  }
  return cloud;
}

}  // namespace planescope::lab
