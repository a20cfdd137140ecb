#include "core/lab/training/training_shapes.hpp"

#include <cmath>

#include "core/lab/synthetic/rectangles.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/lab/synthetic/trigonometry.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {
namespace {

planes::LabelledCloud sampled(const char* kind,
                              std::span<const Rectangle> faces,
                              int points,
                              Random& random) {
  const auto count = static_cast<std::size_t>(points);
  SurfacePoints surface = sample_surface(faces, count, Mat3d::Identity(), random);
  planes::LabelledCloud cloud{kind, std::move(surface.points), {}};
  for (const std::uint32_t face : surface.rectangle)
    cloud.labels.push_back(label_of_normal(faces[face].normal));
  return cloud;
}

/// A frame around [0, length] x [0, width].
void add_floor(std::vector<Rectangle>& faces, double length, double width, double margin) {
  const Vec3d along(length + 2 * margin, 0, 0), across(0, width, 0);
  const Vec3d x(margin, 0, 0), y(0, margin, 0), up = Vec3d::UnitZ();
  faces.push_back({{-margin, -margin, 0}, along, y, up});
  faces.push_back({{-margin, width, 0}, along, y, up});
  faces.push_back({{-margin, 0, 0}, x, across, up});
  faces.push_back({{length, 0, 0}, x, across, up});
}

}  // namespace

planes::LabelledCloud make_stairs_shape(std::uint64_t seed, int points) {
  StairsOptions options;
  options.seed = seed;
  options.points = points;
  options.random_yaw = false;
  options.min_width_m = 0.2;
  options.min_height_m = 0.08;
  const Stairs stairs = make_stairs(0, options);
  planes::LabelledCloud cloud{"stairs", stairs.cloud.points, {}};
  for (const std::uint8_t label : stairs.cloud.label)
    cloud.labels.push_back(static_cast<Label>(label));
  return cloud;
}

planes::LabelledCloud make_box_shape(std::uint64_t seed, int points, bool on_floor) {
  Random random(seed);
  const double length = random.uniform(0.1, 2), width = random.uniform(0.1, 2);
  const double height = random.uniform(0.08, 0.3);
  const Vec3d along(length, 0, 0), across(0, width, 0), up(0, 0, height);
  const Vec3d origin = Vec3d::Zero(), x = Vec3d::UnitX(), y = Vec3d::UnitY();
  std::vector<Rectangle> faces = {{up, along, across, Vec3d::UnitZ()},
                                  {origin, along, up, -y},
                                  {across, along, up, y},
                                  {origin, across, up, -x},
                                  {along, across, up, x}};
  if (on_floor) add_floor(faces, length, width, random.uniform(0.1, 0.5));
  return sampled("box", faces, points, random);
}

planes::LabelledCloud make_plane_shape(std::uint64_t seed, int points) {
  Random random(seed);
  const double length = random.uniform(0.1, 2), width = random.uniform(0.1, 2);
  const double normal_z = random.uniform(-1, 1), azimuth_deg = random.uniform(0, 360);
  const Vec3d level(-sin_deg(azimuth_deg), cos_deg(azimuth_deg), 0);
  const Vec3d ahead(level.y(), -level.x(), 0);
  const Vec3d normal = std::sqrt(1 - normal_z * normal_z) * ahead + normal_z * Vec3d::UnitZ();
  const Rectangle face{Vec3d::Zero(), length * level, width * normal.cross(level), normal};
  return sampled("plane", {&face, 1}, points, random);
}

}  // namespace planescope::lab
