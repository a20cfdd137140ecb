#include "core/synthetic/stairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/synthetic/random.hpp"

namespace planescope {
namespace {

struct Rectangle {
  Vec3d corner;
  Vec3d side_u;
  Vec3d side_v;
  Vec3d normal;
  Label label;
  double area() const { return side_u.norm() * side_v.norm(); }
};

/// Keeps `count` points, each the one farthest from those before it, beginning with point 0.
std::vector<std::uint32_t> farthest_points(const std::vector<Vec3f>& points, std::size_t count) {
  const std::size_t n = points.size();
  std::vector<float> x(n), y(n), z(n), distance2(n, std::numeric_limits<float>::max());
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = points[i].x();
    y[i] = points[i].y();
    z[i] = points[i].z();
  }
  std::vector<std::uint32_t> chosen;
  chosen.reserve(count);
  std::uint32_t next = 0;
  while (chosen.size() < std::min(count, n)) {
    chosen.push_back(next);
    const float px = x[next], py = y[next], pz = z[next];
    for (std::size_t i = 0; i < n; ++i) {
      const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
      distance2[i] = std::min(distance2[i], dx * dx + dy * dy + dz * dz);
    }
    next = static_cast<std::uint32_t>(std::max_element(distance2.begin(), distance2.end()) -
                                      distance2.begin());
  }
  return chosen;
}

}  // namespace

Stairs make_stairs(int index, const StairsOptions& options) {
  Random random(options.seed * 0x9e3779b97f4a7c15ULL +
                static_cast<std::uint64_t>(index) * 0xd1b54a32d192ed03ULL);
  Stairs stairs;
  stairs.steps = random.integer(options.min_steps, options.max_steps);
  stairs.length_m = random.uniform(options.min_length_m, options.max_length_m);
  stairs.width_m = random.uniform(options.min_width_m, options.max_width_m);
  stairs.height_m = random.uniform(options.min_height_m, options.max_height_m);
  const double yaw = random.uniform(0, 2 * std::numbers::pi);
  stairs.yaw_rad = options.random_yaw ? yaw : 0;
  const Mat3d turn = Eigen::AngleAxisd(stairs.yaw_rad, Vec3d::UnitZ()).toRotationMatrix();

  std::vector<Rectangle> faces;
  double area = 0;
  for (int s = 0; s < stairs.steps; ++s) {
    const double x = s * stairs.length_m, z = s * stairs.height_m;
    const Vec3d across(0, stairs.width_m, 0);
    faces.push_back({{x, 0, z}, across, {0, 0, stairs.height_m}, {-1, 0, 0}, Label::v});
    faces.push_back(
        {{x, 0, z + stairs.height_m}, {stairs.length_m, 0, 0}, across, {0, 0, 1}, Label::h});
  }
  for (const Rectangle& f : faces) {
    area += f.area();
    stairs.normals.push_back(turn * f.normal);
  }

  // Dense: four times what is asked for, at least 32768 points, spread evenly by area.
  const std::size_t dense =
      std::max<std::size_t>(32768, 4 * static_cast<std::size_t>(options.points));
  std::vector<Vec3f> points;
  std::vector<std::int32_t> instance;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const Rectangle& f = faces[k];
    const auto n =
        static_cast<std::size_t>(std::lround(static_cast<double>(dense) * f.area() / area));
    for (std::size_t i = 0; i < n; ++i) {
      const double u = random.uniform(), v = random.uniform();
      points.push_back((turn * (f.corner + u * f.side_u + v * f.side_v)).cast<float>());
      instance.push_back(static_cast<std::int32_t>(k) + 1);
    }
  }
  std::vector<std::uint32_t> chosen;
  if (options.points > 0) {
    chosen = farthest_points(points, static_cast<std::size_t>(options.points));
  } else {
    chosen.resize(points.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = static_cast<std::uint32_t>(i);
  }
  for (const std::uint32_t i : chosen) {
    Vec3d p = points[i].cast<double>();
    if (options.noise_m > 0)
      for (int axis = 0; axis < 3; ++axis) p[axis] += options.noise_m * random.normal();
    stairs.cloud.points.push_back(p.cast<float>());
    stairs.cloud.instance.push_back(instance[i]);
    stairs.cloud.label.push_back(static_cast<std::uint8_t>(faces[instance[i] - 1].label));
  }
  return stairs;
}

}  // namespace planescope
