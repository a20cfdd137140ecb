#include "core/lab/synthetic/shading.hpp"

#include <algorithm>
#include <cmath>

#include "core/lab/synthetic/texture.hpp"

namespace planescope::lab {
namespace {

constexpr double kLampDistanceM = 20;
constexpr double kContactM = 0.35;  // how far a neighbouring surface darkens

}  // namespace

double openness(const Scene& scene, const CastScene& cast, int surface, const Vec3d& point) {
  // One short ray along each of a few directions.
  static const Vec3d kDirections[] = {{0.8, 0, 0.6},    {-0.8, 0, 0.6},   {0, 0.8, 0.6},
                                      {0, -0.8, 0.6},   {0.7, 0.7, 0.1},  {-0.7, 0.7, 0.1},
                                      {0.7, -0.7, 0.1}, {-0.7, -0.7, 0.1}};
  const Vec3d& normal = scene.surfaces[surface].normal;
  double open = 0, total = 0;
  for (const Vec3d& direction : kDirections) {
    const double weight = normal.dot(direction);
    if (weight <= 0.05) continue;
    total += weight;
    const Hit hit = first_hit(cast, point + 1e-5 * normal, direction);
    const double distance = hit.surface < 0 ? kContactM : std::min(hit.t, kContactM);
    open += weight * distance / kContactM;
  }
  return total > 0 ? open / total : 1;
}

Vec3d shade(
    const Scene& scene, const CastScene& cast, int surface, const Vec3d& point, double open) {
  const Surface& s = scene.surfaces[surface];
  const double facing = s.normal.dot(scene.light);
  const bool lit = facing > 0 && !is_blocked(cast, point, point + kLampDistanceM * scene.light);
  const double sky = 0.5 + 0.5 * s.normal.z();
  const double ambient = (0.28 + 0.27 * sky) * (0.45 + 0.55 * open);
  const double lamp = lit ? 0.75 * facing : 0;
  const Vec3d light = ambient * Vec3d(0.94, 0.98, 1.06) + lamp * Vec3d(1.06, 1.0, 0.9);
  return textured_albedo(s, surface, point).cwiseProduct(light);
}

std::array<std::uint8_t, 3> to_display(const Vec3d& linear) {
  std::array<std::uint8_t, 3> rgb{};
  for (int c = 0; c < 3; ++c) {
    const double value = std::sqrt(std::clamp(linear[c], 0.0, 1.0));
    rgb[c] = static_cast<std::uint8_t>(std::lround(255 * value));
  }
  return rgb;
}

}  // namespace planescope::lab
