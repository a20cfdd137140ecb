#include <algorithm>

#include "core/lab/synthetic/evaluation_scenes.hpp"
#include "core/lab/synthetic/scene_parts.hpp"
#include "core/lab/synthetic/trigonometry.hpp"

namespace planescope::lab {
namespace {

const Footprint kGround{{-kFarM, kFarM}, {-kFarM, kFarM}};

/// Where things begin, before the camera.
double place_camera(Scene& scene, Random& random) {
  scene.camera.position = {0, 0, random.uniform(0.6, 1.0)};
  scene.camera.pitch_deg = random.uniform(25, 45);
  scene.camera.yaw_deg = random.uniform(-10, 10);
  scene.camera.roll_deg = random.uniform(-4, 4);
  return random.uniform(0.5, 1.1);
}

/// More or less in the middle of the view.
Range place_across(double width, Random& random) {
  const double middle = random.uniform(-0.25, 0.25);
  return {middle - width / 2, middle + width / 2};
}

/// Turned about the point of its front before the camera, so that it stays as far away, and put on
/// the ground.
void set_down(Scene& scene, double front, double max_angle_deg, Random& random) {
  turn(scene, {front, 0, 0}, random.uniform(-max_angle_deg, max_angle_deg));
  add_ground(scene, kGround);
}

struct Disc {
  Vec2d center;
  double radius = 0;
};
bool overlap(const Disc& a, const Disc& b) {
  return (a.center - b.center).norm() < a.radius + b.radius;
}

}  // namespace

void build_stairs_view(Scene& scene, Random& random) {
  const double front = place_camera(scene, random);
  const double width = random.uniform(0.3, 1.5);
  Steps steps{front, place_across(width, random)};
  steps.count = random.integer(2, 6);
  steps.length_m = random.uniform(0.2, 0.4);
  steps.height_m = random.uniform(0.1, 0.3);
  add_steps(scene, steps);
  add_flanks(scene, steps);
  if (random.uniform() < 0.5)
    add_polygon(scene, upright({steps.end(), kFarM}, {steps.end(), -kFarM}, {0, 2.5}), {});
  set_down(scene, front, 25, random);
}

void build_boxes_view(Scene& scene, Random& random) {
  const double front = place_camera(scene, random);
  const int boxes = random.integer(3, 6);
  std::vector<Disc> taken;
  constexpr int kMaxTries = 500;  // where big ones leave no room, there are fewer
  for (int i = 0; i < kMaxTries && std::ssize(taken) < boxes; ++i) {
    const double length = random.uniform(0.12, 0.5), width = random.uniform(0.12, 0.5);
    const double height = random.uniform(0.08, 0.4), yaw_deg = random.uniform(0, 90);
    const double radius = Vec2d(length, width).norm() / 2;
    const double x = front + radius + random.uniform(0, 1), y = random.uniform(-0.8, 0.8);
    const Disc place{{x, y}, radius};
    if (std::any_of(taken.begin(), taken.end(),
                    [&](const Disc& other) { return overlap(place, other); }))
      continue;
    taken.push_back(place);
    add_box(scene, {x, y, 0}, {length, width, height}, yaw_deg, {});
  }
  add_ground(scene, kGround);
}

/// A ramp that stands alone, leads up to a pavement, or runs beside one.
void build_slopes_view(Scene& scene, Random& random) {
  const double front = place_camera(scene, random);
  const double width = random.uniform(0.4, 1.2), angle_deg = random.uniform(5, 35);
  const double slope = sin_deg(angle_deg) / cos_deg(angle_deg);
  Ramp ramp{front, place_across(width, random)};
  ramp.run_m = std::min(random.uniform(0.5, 1.2), 0.4 / slope);
  ramp.rise_m = ramp.run_m * slope;
  const int kind = random.integer(0, 2);
  if (kind != 1) ramp.landing_m = random.uniform(0.2, 0.6);
  add_ramp(scene, ramp);
  if (kind == 1) {
    const double x = ramp.top();
    const Range z{0, ramp.rise_m};
    const int kerb = add_polygon(scene, upright({x, kFarM}, {x, ramp.y.high}, z), {});
    add_polygon(scene, upright({x, ramp.y.low}, {x, -kFarM}, z), {}, kerb);
    add_polygon(scene, level({x, x + kFarM}, {-kFarM, kFarM}, z.high), {});
  } else if (kind == 2) {
    const double y = ramp.y.high + random.uniform(0.1, 0.4), z = random.uniform(0.05, 0.2);
    add_polygon(scene, upright({-kFarM, y}, {kFarM, y}, {0, z}), {});
    add_polygon(scene, level({-kFarM, kFarM}, {y, kFarM}, z), {});
  }
  set_down(scene, front, 25, random);
}

}  // namespace planescope::lab
