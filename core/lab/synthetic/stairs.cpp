#include "core/lab/synthetic/stairs.hpp"

#include <algorithm>
#include <numbers>

#include "core/lab/synthetic/surface_points.hpp"
#include "core/model/random.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {
namespace {

Mat3d turn_of(const Stairs& stairs) {
  return Eigen::AngleAxisd(stairs.yaw_rad, Vec3d::UnitZ()).toRotationMatrix();
}

/// Riser, tread, riser, ... before the staircase is turned.
std::vector<Rectangle> faces_of(const Stairs& stairs) {
  std::vector<Rectangle> faces;
  for (int s = 0; s < stairs.steps; ++s) {
    const double x = s * stairs.length_m, z = s * stairs.height_m;
    const Vec3d across(0, stairs.width_m, 0);
    faces.push_back({{x, 0, z}, across, {0, 0, stairs.height_m}, {-1, 0, 0}});
    faces.push_back({{x, 0, z + stairs.height_m}, {stairs.length_m, 0, 0}, across, {0, 0, 1}});
  }
  return faces;
}

double distance(const Vec3d& p, const Rectangle& face) {
  const Vec3d d = p - face.corner;
  const double u = face.side_u.squaredNorm(), v = face.side_v.squaredNorm();
  return (d - std::clamp(d.dot(face.side_u) / u, 0.0, 1.0) * face.side_u -
          std::clamp(d.dot(face.side_v) / v, 0.0, 1.0) * face.side_v)
      .norm();
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
  const Mat3d turn = turn_of(stairs);
  const std::vector<Rectangle> faces = faces_of(stairs);
  for (const Rectangle& f : faces) stairs.normals.push_back(turn * f.normal);

  const SurfacePoints surface =
      sample_surface(faces, static_cast<std::size_t>(options.points), turn, random);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const std::uint32_t face = surface.rectangle[i];
    stairs.cloud.points.push_back(with_noise(surface.points[i], options.noise_m, random));
    stairs.cloud.instance.push_back(static_cast<std::int32_t>(face) + 1);
    stairs.cloud.label.push_back(static_cast<std::uint8_t>(label_of_normal(faces[face].normal)));
  }
  return stairs;
}

std::vector<TruePolygon> true_polygons(const Stairs& stairs) {
  const Mat3d turn = turn_of(stairs);
  std::vector<TruePolygon> polygons;
  for (const Rectangle& f : faces_of(stairs)) {
    const Vec3d far = f.corner + f.side_u + f.side_v;
    polygons.push_back(
        {{turn * f.corner, turn * (f.corner + f.side_u), turn * far, turn * (f.corner + f.side_v)},
         static_cast<int>(polygons.size()) + 1});
  }
  return polygons;
}

planes::LabelledCloud labelled(const Stairs& stairs) {
  planes::LabelledCloud cloud{"stairs", stairs.cloud.points, {}, {}};
  const Mat3d turn_back = turn_of(stairs).transpose();
  const std::vector<Rectangle> faces = faces_of(stairs);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto label = static_cast<Label>(stairs.cloud.label[i]);
    const Vec3d p = turn_back * cloud.points[i].cast<double>();
    const bool near = std::any_of(faces.begin(), faces.end(), [&](const Rectangle& face) {
      return label_of_normal(face.normal) != label && distance(p, face) < planes::kEdgeDistanceM;
    });
    cloud.labels.push_back(label);
    cloud.near_edge.push_back(near);
  }
  return cloud;
}

}  // namespace planescope::lab
