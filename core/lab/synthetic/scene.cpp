#include "core/lab/synthetic/scene.hpp"

#include <cassert>

#include "core/lab/synthetic/trigonometry.hpp"

namespace planescope::lab {
namespace {

Vec3d rotated(const Vec3d& v, double sine, double cosine) {
  return {cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y(), v.z()};
}

}  // namespace

Pose pose_of(const CameraPose& camera) {
  const double sy = sin_deg(camera.yaw_deg), cy = cos_deg(camera.yaw_deg);
  const double sp = sin_deg(camera.pitch_deg), cp = cos_deg(camera.pitch_deg);
  const double sr = sin_deg(camera.roll_deg), cr = cos_deg(camera.roll_deg);
  // Level camera: right and down follow from the direction it looks in.
  const Vec3d forward(cy * cp, sy * cp, -sp);
  const Vec3d right(sy, -cy, 0);
  const Vec3d down = forward.cross(right);
  Pose T_world_camera = Pose::Identity();
  T_world_camera.linear().col(0) = cr * right + sr * down;
  T_world_camera.linear().col(1) = cr * down - sr * right;
  T_world_camera.linear().col(2) = forward;
  T_world_camera.translation() = camera.position;
  return T_world_camera;
}

int add_polygon(Scene& scene, std::vector<Vec3d> corners, const Material& material, int plane) {
  assert(corners.size() >= 3);
  Surface surface;
  surface.normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  surface.corners = std::move(corners);
  surface.plane = plane > 0 ? plane : ++scene.planes;
  surface.material = material;
  scene.surfaces.push_back(std::move(surface));
  return scene.surfaces.back().plane;
}

void add_curved(Scene& scene, std::vector<Vec3d> corners, const Material& material) {
  add_polygon(scene, std::move(corners), material, 1);
  scene.surfaces.back().plane = 0;
}

void add_box(
    Scene& scene, const Vec3d& base, const Vec3d& size, double yaw_deg, const Material& material) {
  const double sine = sin_deg(yaw_deg), cosine = cos_deg(yaw_deg);
  const double hx = size.x() / 2, hy = size.y() / 2;
  const Vec3d foot[4] = {{-hx, -hy, 0}, {hx, -hy, 0}, {hx, hy, 0}, {-hx, hy, 0}};
  const Vec3d up(0, 0, size.z());
  std::vector<Vec3d> top;
  for (int i = 0; i < 4; ++i) {
    const Vec3d a = base + rotated(foot[i], sine, cosine);
    const Vec3d b = base + rotated(foot[(i + 1) % 4], sine, cosine);
    add_polygon(scene, {a, b, b + up, a + up}, material);
    top.push_back(a + up);
  }
  add_polygon(scene, top, material);
}

void add_cylinder(
    Scene& scene, const Vec3d& base, double radius_m, double height_m, const Material& material) {
  constexpr int kFacets = 32;
  const Vec3d up(0, 0, height_m);
  std::vector<Vec3d> lid;
  for (int i = 0; i < kFacets; ++i) {
    const double a = 360.0 * i / kFacets, b = 360.0 * (i + 1) / kFacets;
    const Vec3d p = base + radius_m * Vec3d(cos_deg(a), sin_deg(a), 0);
    const Vec3d q = base + radius_m * Vec3d(cos_deg(b), sin_deg(b), 0);
    add_curved(scene, {p, q, q + up, p + up}, material);
    lid.push_back(p + up);
  }
  add_polygon(scene, lid, material);
}

}  // namespace planescope::lab
