#include "core/lab/synthetic/composed_scene.hpp"

#include <algorithm>
#include <cmath>

#include "core/lab/synthetic/trigonometry.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {
namespace {

/// A solid of a constant outline: a convex polygon in x-z, counter-clockwise seen from -y, drawn
/// out from y = right to y = left.
struct Prism {
  std::vector<Vec2d> outline;
  double right = 0, left = 0;
};

/// Adds surfaces to a scene, turned about the vertical through a point.
class Turned {
 public:
  Turned(Scene& scene, const Vec3d& center, double angle_deg)
      : scene_(scene), center_(center), sine_(sin_deg(angle_deg)), cosine_(cos_deg(angle_deg)) {}

  void add(std::vector<Vec3d> corners) {
    for (Vec3d& c : corners) {
      const Vec3d d = c - center_;
      c = center_ + Vec3d(cosine_ * d.x() - sine_ * d.y(), sine_ * d.x() + cosine_ * d.y(), d.z());
    }
    add_polygon(scene_, std::move(corners), {});
  }

  /// All faces of a prism but those that lie on the floor.
  void add(const Prism& prism) {
    const auto at = [](const Vec2d& p, double y) { return Vec3d(p.x(), y, p.y()); };
    std::vector<Vec3d> right_side, left_side;
    for (std::size_t i = 0; i < prism.outline.size(); ++i) {
      const Vec2d &a = prism.outline[i], &b = prism.outline[(i + 1) % prism.outline.size()];
      right_side.push_back(at(a, prism.right));
      left_side.insert(left_side.begin(), at(a, prism.left));
      if (a.y() == 0 && b.y() == 0) continue;
      add({at(a, prism.right), at(a, prism.left), at(b, prism.left), at(b, prism.right)});
    }
    add(right_side);
    add(left_side);
  }

 private:
  Scene& scene_;
  Vec3d center_;
  double sine_, cosine_;
};

struct Place {
  double right = 0, left = 0;
};
/// Something of this width stands more or less in the middle of the view.
Place place(double width, Random& random) {
  const double middle = random.uniform(-0.3, 0.3);
  return {middle - width / 2, middle + width / 2};
}

void add_stairs(Turned& to, double front, Random& random) {
  const int steps = random.integer(2, 6);
  const double going = random.uniform(0.2, 0.4), rise = random.uniform(0.08, 0.3);
  const Place across = place(random.uniform(0.2, 1.5), random);
  for (int i = 0; i < steps; ++i) {
    // Riser, tread, and the strips of the flanks below the tread.
    const double x = front + i * going, end = front + (i + 1) * going;
    const double low = i * rise, z = low + rise;
    to.add(
        {{x, across.left, low}, {x, across.right, low}, {x, across.right, z}, {x, across.left, z}});
    to.add(
        {{x, across.right, z}, {end, across.right, z}, {end, across.left, z}, {x, across.left, z}});
    for (const double y : {across.right, across.left})
      to.add({{x, y, 0}, {end, y, 0}, {end, y, z}, {x, y, z}});
  }
}

void add_boxes(Scene& scene, double front, Random& random) {
  const int boxes = random.integer(1, 5);
  for (int i = 0; i < boxes; ++i) {
    const double length = random.uniform(0.1, 0.8), width = random.uniform(0.1, 0.8);
    const double height = random.uniform(0.08, 0.3);
    const double x = front + std::max(length, width) * 0.75 + random.uniform(0, 0.8);
    const double y = random.uniform(-0.7, 0.7), yaw_deg = random.uniform(0, 90);
    add_box(scene, {x, y, 0}, {length, width, height}, yaw_deg, {});
  }
}

void add_kerb(Turned& to, double front, Random& random) {
  const double height = random.uniform(0.05, 0.3);
  const double depth = random.uniform() < 0.5 ? kFarM : random.uniform(0.1, 0.5);
  to.add(
      {{{front, 0}, {front + depth, 0}, {front + depth, height}, {front, height}}, -kFarM, kFarM});
}

/// A ramp, or a slab too steep to walk on, with a level top behind it.
void add_ramp(Turned& to, double front, Random& random) {
  const bool steep = random.uniform() < 0.25;
  const double angle_deg = steep ? random.uniform(52, 80) : random.uniform(4, 38);
  const double length = random.uniform(0.2, 1.2), top = random.uniform(0.1, 0.8);
  const double run = length * cos_deg(angle_deg), rise = length * sin_deg(angle_deg);
  const Place across = place(random.uniform(0.3, 1.5), random);
  to.add({{{front, 0}, {front + run + top, 0}, {front + run + top, rise}, {front + run, rise}},
          across.right,
          across.left});
}

void add_walls(Scene& scene, double front, Random& random) {
  const double height = random.uniform(0.5, 2.5);
  if (random.uniform() < 0.5) {
    const double x = front + random.uniform(0.2, 1.2);
    Turned wall(scene, {x, 0, 0}, random.uniform(-20, 20));
    wall.add({{x, kFarM, 0}, {x, -kFarM, 0}, {x, -kFarM, height}, {x, kFarM, height}});
  }
  if (random.uniform() < 0.5) {
    const bool left = random.uniform() < 0.5;
    const double distance = random.uniform(0.3, 1), y = left ? distance : -distance;
    Turned wall(scene, {0, y, 0}, random.uniform(-10, 10));
    wall.add({{-kFarM, y, 0}, {kFarM, y, 0}, {kFarM, y, height}, {-kFarM, y, height}});
  }
}

CameraPose random_camera(Random& random) {
  CameraPose camera;
  camera.position = {0, 0, random.uniform(0.4, 1.2)};
  camera.pitch_deg = random.uniform(15, 60);
  camera.yaw_deg = random.uniform(-15, 15);
  camera.roll_deg = random.uniform(-10, 10);
  return camera;
}

}  // namespace

Scene compose_scene(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  scene.name = "composed";
  scene.camera = random_camera(random);
  add_polygon(scene,
              {{-kFarM, -kFarM, 0}, {kFarM, -kFarM, 0}, {kFarM, kFarM, 0}, {-kFarM, kFarM, 0}}, {});
  const double front = random.uniform(0.3, 1.5);
  // Turned about the point of its front before the camera, so that it stays as far away.
  Turned thing(scene, {front, 0, 0}, random.uniform(-25, 25));
  switch (random.integer(0, 4)) {
    case 0:
    case 1:
      add_stairs(thing, front, random);
      break;
    case 2:
      add_boxes(scene, front, random);
      break;
    case 3:
      add_kerb(thing, front, random);
      break;
    default:
      add_ramp(thing, front, random);
  }
  if (random.uniform() < 0.3) add_boxes(scene, front, random);
  add_walls(scene, front, random);
  return scene;
}

}  // namespace planescope::lab
