// Building blocks of synthetic scenes: polygons, boxes, cylinders, steps and ramps.

#include "core/lab/synthetic/scene.hpp"

#include <algorithm>
#include <cassert>

#include "core/lab/synthetic/repeatable.hpp"

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
  // Level camera: right and down follow from the forward direction.
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

// ---- Parts of scenes ----

std::vector<Vec3d> level(const Range& x, const Range& y, double z) {
  return {{x.low, y.low, z}, {x.high, y.low, z}, {x.high, y.high, z}, {x.low, y.high, z}};
}

std::vector<Vec3d> upright(const Vec2d& a, const Vec2d& b, const Range& z) {
  return {
      {a.x(), a.y(), z.low}, {b.x(), b.y(), z.low}, {b.x(), b.y(), z.high}, {a.x(), a.y(), z.high}};
}

void add_ground(Scene& scene,
                const Footprint& whole,
                std::span<const Footprint> holes,
                const Material& material) {
  std::vector<double> cuts = {whole.x.low, whole.x.high};
  for (const Footprint& hole : holes) cuts.insert(cuts.end(), {hole.x.low, hole.x.high});
  std::sort(cuts.begin(), cuts.end());
  int plane = 0;
  // Strips between the cuts, each without its parts in the holes.
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const Range x{cuts[i], cuts[i + 1]};
    if (x.size() <= 0) continue;
    std::vector<Range> gaps;
    for (const Footprint& hole : holes)
      if (hole.x.low <= x.low && hole.x.high >= x.high) gaps.push_back(hole.y);
    std::sort(gaps.begin(), gaps.end(),
              [](const Range& a, const Range& b) { return a.low < b.low; });
    gaps.push_back({whole.y.high, whole.y.high});
    double y = whole.y.low;
    for (const Range& gap : gaps) {
      if (gap.low > y) plane = add_polygon(scene, level(x, {y, gap.low}, 0), material, plane);
      y = gap.high;
    }
  }
}

std::vector<int> add_steps(Scene& scene, const Steps& steps) {
  std::vector<int> treads;
  for (int i = 0; i < steps.count; ++i) {
    const double x = steps.x + i * steps.length_m, z = i * steps.height_m;
    const Vec2d left(x, steps.y.high), right(x, steps.y.low);
    add_polygon(scene, upright(left, right, {z, z + steps.height_m}), {});
    treads.push_back(
        add_polygon(scene, level({x, x + steps.length_m}, steps.y, z + steps.height_m), {}));
  }
  return treads;
}

void add_flanks(Scene& scene, const Steps& steps) {
  int right = 0, left = 0;
  for (int i = 0; i < steps.count; ++i) {
    const double x = steps.x + i * steps.length_m, end = x + steps.length_m;
    const Range z{0, (i + 1) * steps.height_m};
    right = add_polygon(scene, upright({x, steps.y.low}, {end, steps.y.low}, z), {}, right);
    left = add_polygon(scene, upright({end, steps.y.high}, {x, steps.y.high}, z), {}, left);
  }
}

void add_ramp(Scene& scene, const Ramp& ramp) {
  const double x = ramp.x, top = ramp.top(), end = ramp.end(), z = ramp.rise_m;
  const double right = ramp.y.low, left = ramp.y.high;
  add_polygon(scene, {{x, right, 0}, {top, right, z}, {top, left, z}, {x, left, 0}}, {});
  std::vector<Vec3d> right_side = {{x, right, 0}, {end, right, 0}, {end, right, z}};
  std::vector<Vec3d> left_side = {{end, left, z}, {end, left, 0}, {x, left, 0}};
  if (ramp.landing_m > 0) {
    add_polygon(scene, level({top, end}, ramp.y, z), {});
    right_side.emplace_back(top, right, z);
    left_side.emplace_back(top, left, z);
  }
  add_polygon(scene, right_side, {});
  add_polygon(scene, left_side, {});
  add_polygon(scene, upright({end, right}, {end, left}, {0, z}), {});
}

void turn(Scene& scene, const Vec3d& center, double angle_deg) {
  const Mat3d turned = rotation(Vec3d::UnitZ(), angle_deg);
  for (Surface& surface : scene.surfaces) {
    for (Vec3d& corner : surface.corners) corner = center + turned * (corner - center);
    surface.normal = turned * surface.normal;
  }
  if (!scene.stairs) return;
  for (TrueStep& step : scene.stairs->steps)
    for (Vec3d* end : {&step.right, &step.left}) *end = center + turned * (*end - center);
}

}  // namespace planescope::lab
