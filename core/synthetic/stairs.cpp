#include "core/synthetic/stairs.hpp"

#include <numbers>

#include "core/synthetic/random.hpp"
#include "core/synthetic/rectangles.hpp"
#include "core/synthetic/truth.hpp"

namespace planescope {

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
  for (int s = 0; s < stairs.steps; ++s) {
    const double x = s * stairs.length_m, z = s * stairs.height_m;
    const Vec3d across(0, stairs.width_m, 0);
    faces.push_back({{x, 0, z}, across, {0, 0, stairs.height_m}, {-1, 0, 0}});
    faces.push_back({{x, 0, z + stairs.height_m}, {stairs.length_m, 0, 0}, across, {0, 0, 1}});
  }
  for (const Rectangle& f : faces) stairs.normals.push_back(turn * f.normal);

  const SurfacePoints surface =
      sample_surface(faces, static_cast<std::size_t>(options.points), turn, random);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    Vec3d p = surface.points[i].cast<double>();
    if (options.noise_m > 0)
      for (int axis = 0; axis < 3; ++axis) p[axis] += options.noise_m * random.normal();
    const std::uint32_t face = surface.rectangle[i];
    stairs.cloud.points.push_back(p.cast<float>());
    stairs.cloud.instance.push_back(static_cast<std::int32_t>(face) + 1);
    stairs.cloud.label.push_back(static_cast<std::uint8_t>(true_label(faces[face].normal)));
  }
  return stairs;
}

}  // namespace planescope
