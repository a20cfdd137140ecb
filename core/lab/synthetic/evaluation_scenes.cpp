// Random scenes of the evaluation sets.

#include <algorithm>
#include <cmath>
#include <map>

#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scenes.hpp"

namespace planescope::lab {
// ---- Whole objects, with points sampled on all of their faces ----

namespace {

/// `count` consecutive ranges starting at 0, separated by gaps.
std::vector<Range> in_a_row(int count, const Range& size, const Range& gap, Random& random) {
  std::vector<Range> row;
  double at = 0;
  for (int i = 0; i < count; ++i) {
    const double end = at + random.uniform(size.low, size.high);
    row.push_back({at, end});
    at = end + random.uniform(gap.low, gap.high);
  }
  return row;
}

void build_side_walls(Scene& scene, Random& random) {
  Steps steps;
  steps.count = random.integer(2, 5);
  steps.length_m = random.uniform(0.2, 0.4);
  steps.height_m = random.uniform(0.1, 0.3);
  steps.y = {0, random.uniform(0.6, 1.5)};
  const Range before{-random.uniform(0.3, 0.6), 0};
  const double wall_top = steps.top() + random.uniform(0.4, 0.8);
  const bool both = random.uniform() < 0.5;
  add_polygon(scene, level(before, steps.y, 0), {});
  add_steps(scene, steps);
  // Walls are visible above the ground and above each tread.
  int left = 0, right = 0;
  for (int i = 0; i <= steps.count; ++i) {
    const double end = i * steps.length_m;
    const Range x = i == 0 ? before : Range{end - steps.length_m, end};
    const Range z{i * steps.height_m, wall_top};
    left = add_polygon(scene, upright({x.low, steps.y.high}, {x.high, steps.y.high}, z), {}, left);
    if (both)
      right =
          add_polygon(scene, upright({x.high, steps.y.low}, {x.low, steps.y.low}, z), {}, right);
  }
}

void build_open_risers(Scene& scene, Random& random) {
  const int treads = random.integer(3, 6);
  const double length = random.uniform(0.22, 0.32), height = random.uniform(0.15, 0.22);
  const double width = random.uniform(0.5, 1.2), thickness = random.uniform(0.03, 0.05);
  const double nosing = random.uniform(0, 0.04);  // overlap of treads
  for (int i = 0; i < treads; ++i) {
    const Vec3d foot((i + 0.5) * length, 0, (i + 1) * height - thickness);
    add_box(scene, foot, {length + nosing, width, thickness}, 0, {});
  }
  const double margin = random.uniform(0.2, 0.5);
  add_ground(scene,
             {{-margin, treads * length + margin}, {-width / 2 - margin, width / 2 + margin}});
}

void build_spiral(Scene& scene, Random& random) {
  const int steps = random.integer(4, 8);
  const double step_deg = random.uniform(22, 35), height = random.uniform(0.14, 0.2);
  const double pole_radius = random.uniform(0.05, 0.1), radius = random.uniform(0.6, 1.0);
  const double pole_top = steps * height + random.uniform(0.3, 0.6);
  const auto at = [](double angle_deg, double r) {
    return Vec2d(r * cos_deg(angle_deg), r * sin_deg(angle_deg));
  };
  for (int i = 0; i < steps; ++i) {
    const double z = (i + 1) * height;
    const Vec2d pole_a = at(i * step_deg, pole_radius),
                pole_b = at((i + 1) * step_deg, pole_radius);
    const Vec2d rim_a = at(i * step_deg, radius), rim_b = at((i + 1) * step_deg, radius);
    add_polygon(scene, upright(pole_a, rim_a, {i * height, z}), {});
    add_polygon(scene,
                {{pole_a.x(), pole_a.y(), z},
                 {rim_a.x(), rim_a.y(), z},
                 {rim_b.x(), rim_b.y(), z},
                 {pole_b.x(), pole_b.y(), z}},
                {});
    add_curved(scene, upright(pole_a, pole_b, {z, pole_top}), {});
  }
  // The side of the pole not hidden by steps.
  const double start_deg = steps * step_deg;
  const int facets = static_cast<int>(std::ceil((360 - start_deg) / 30));
  for (int i = 0; i < facets; ++i) {
    const double facet_deg = (360 - start_deg) / facets;
    const Vec2d a = at(start_deg + i * facet_deg, pole_radius);
    const Vec2d b = at(start_deg + (i + 1) * facet_deg, pole_radius);
    add_curved(scene, upright(a, b, {0, pole_top}), {});
  }
}

void build_equal_boxes(Scene& scene, Random& random) {
  const Range gap{0.05, 0.3};
  const int columns = random.integer(3, 4), rows = random.integer(1, 2);
  const std::vector<Range> lengths = in_a_row(columns, {0.2, 0.5}, gap, random);
  const std::vector<Range> widths = in_a_row(rows, {0.2, 0.5}, gap, random);
  const double height = random.uniform(0.1, 0.4), margin = random.uniform(0.1, 0.4);
  std::vector<Footprint> boxes;
  for (const Range& x : lengths)
    for (const Range& y : widths) boxes.push_back({x, y});
  for (const Footprint& box : boxes) {
    const Vec3d foot((box.x.low + box.x.high) / 2, (box.y.low + box.y.high) / 2, 0);
    add_box(scene, foot, {box.x.size(), box.y.size(), height}, 0, {});
  }
  add_ground(scene,
             {{-margin, lengths.back().high + margin}, {-margin, widths.back().high + margin}},
             boxes);
}

void build_ramps(Scene& scene, Random& random) {
  const double angle_deg = random.uniform(5, 25);
  Ramp ramp;
  ramp.y = {0, random.uniform(0.4, 0.9)};
  ramp.run_m = random.uniform(0.5, 1.2);
  ramp.rise_m = ramp.run_m * sin_deg(angle_deg) / cos_deg(angle_deg);
  if (random.uniform() < 0.5) ramp.landing_m = random.uniform(0.2, 0.5);
  add_ramp(scene, ramp);
  const double margin = random.uniform(0.2, 0.5);
  const Footprint foot{{ramp.x, ramp.end()}, ramp.y};
  add_ground(scene, {{ramp.x - margin, ramp.end() + margin}, {-margin, ramp.y.high + margin}},
             {&foot, 1});
}

/// A straight kerb, or the corner of a pavement.
void build_kerbs(Scene& scene, Random& random) {
  const double height = random.uniform(0.02, 0.15);
  const Range x{-random.uniform(0.5, 1.2), random.uniform(0.4, 1.0)};
  const Range y{0, random.uniform(0.8, 1.6)};
  const bool corner = random.uniform() < 0.5;
  const Range pavement{corner ? random.uniform(0.3, 0.6) * y.high : 0, y.high};
  const Footprint raised{{0, x.high}, pavement};
  add_ground(scene, {x, y}, {&raised, 1});
  add_polygon(scene, level(raised.x, raised.y, height), {});
  add_polygon(scene, upright({0, pavement.high}, {0, pavement.low}, {0, height}), {});
  if (corner)
    add_polygon(scene, upright({0, pavement.low}, {x.high, pavement.low}, {0, height}), {});
}

// ---- Views: something on the ground, 0.5 to 1.1 m before a camera that is 0.6 to 1 m high and
// pitched down by 25 to 45 degrees. How much of it is visible is random. ----

const Footprint kGround{{-kFarM, kFarM}, {-kFarM, kFarM}};

/// Places the camera and returns the distance at which objects begin.
double place_camera(Scene& scene, Random& random) {
  scene.camera.position = {0, 0, random.uniform(0.6, 1.0)};
  scene.camera.pitch_deg = random.uniform(25, 45);
  scene.camera.yaw_deg = random.uniform(-10, 10);
  scene.camera.roll_deg = random.uniform(-4, 4);
  return random.uniform(0.5, 1.1);
}

/// Near the middle of the view.
Range place_across(double width, Random& random) {
  const double middle = random.uniform(-0.25, 0.25);
  return {middle - width / 2, middle + width / 2};
}

/// Rotates the scene about its front point, so that the distance stays the same, and adds the
/// ground.
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

void build_stairs_view(Scene& scene, Random& random) {
  const double front = place_camera(scene, random);
  const double width = random.uniform(0.3, 1.5);
  Steps steps{front, place_across(width, random)};
  steps.count = random.integer(2, 6);
  steps.length_m = random.uniform(0.2, 0.4);
  steps.height_m = random.uniform(0.1, 0.3);
  scene.stairs = TrueStairs{steps.height_m, steps.length_m, width, /*seen_from_above=*/false, {}};
  const std::vector<int> treads = add_steps(scene, steps);
  for (int i = 0; i < steps.count; ++i) {
    const double x = front + i * steps.length_m, z = (i + 1) * steps.height_m;
    scene.stairs->steps.push_back(
        {{x, steps.y.low, z}, {x, steps.y.high, z}, i > 0 ? treads[i - 1] : 0, treads[i]});
  }
  add_flanks(scene, steps);
  if (random.uniform() < 0.5)
    add_polygon(scene, upright({steps.end(), kFarM}, {steps.end(), -kFarM}, {0, 2.5}), {});
  set_down(scene, front, 25, random);
  scene.stairs->steps[0].before = scene.planes;  // the ground
}

void build_boxes_view(Scene& scene, Random& random) {
  const double front = place_camera(scene, random);
  const int boxes = random.integer(3, 6);
  std::vector<Disc> taken;
  constexpr int kMaxTries = 500;  // large boxes may not leave room for all
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

/// A ramp that is isolated, leads up to a pavement, or runs beside one.
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

/// Stairs seen from their top: a camera 0.5 to 0.9 m above the landing and 0.2 to 0.6 m behind its
/// edge, pitched down by 30 to 55 degrees; between walls or open to the sides.
void build_descent_view(Scene& scene, Random& random) {
  const int count = random.integer(2, 6);
  const double rise = random.uniform(0.1, 0.3), going = random.uniform(0.2, 0.4);
  const double width = random.uniform(0.6, 1.5), edge = random.uniform(0.2, 0.6);
  const double top = count * rise, bottom = edge + (count - 1) * going;
  scene.camera.position = {0, 0, top + random.uniform(0.5, 0.9)};
  scene.camera.pitch_deg = random.uniform(30, 55);
  scene.camera.yaw_deg = random.uniform(-10, 10);
  scene.camera.roll_deg = random.uniform(-4, 4);
  const Range y = place_across(width, random);
  scene.stairs = TrueStairs{rise, going, width, /*seen_from_above=*/true, {}};
  // From the lowest: risers face away from the camera, the last tread is the landing.
  for (int i = 0; i < count; ++i) {
    const double x = bottom - i * going, z = (i + 1) * rise;
    add_polygon(scene, upright({x, y.low}, {x, y.high}, {z - rise, z}), {});
    const double back = i + 1 < count ? x - going : -kFarM;
    const int tread = add_polygon(scene, level({back, x}, y, z), {});
    const int before = i > 0 ? scene.stairs->steps.back().tread : 0;
    scene.stairs->steps.push_back({{x, y.high, z}, {x, y.low, z}, before, tread});
  }
  if (random.uniform() < 0.5) {  // between walls
    add_polygon(scene, upright({-kFarM, y.high}, {kFarM, y.high}, {0, top + 2}), {});
    add_polygon(scene, upright({kFarM, y.low}, {-kFarM, y.low}, {0, top + 2}), {});
  } else {
    int right = 0, left = 0;
    for (int i = 0; i < count; ++i) {
      const double x = bottom - i * going, back = i + 1 < count ? x - going : -kFarM;
      const Range z{0, (i + 1) * rise};
      right = add_polygon(scene, upright({back, y.low}, {x, y.low}, z), {}, right);
      left = add_polygon(scene, upright({x, y.high}, {back, y.high}, z), {}, left);
    }
  }
  set_down(scene, edge, 25, random);
  scene.stairs->steps[0].before = scene.planes;  // the ground
}

}  // namespace

BuildScene build_of_set(const std::string& set) {
  static const std::map<std::string, BuildScene> builds = {
      {"side_walls", build_side_walls},
      {"open_risers", build_open_risers},
      {"equal_boxes", build_equal_boxes},
      {"ramps", build_ramps},
      {"kerbs", build_kerbs},
      {"spiral", build_spiral},
      {"depth_stairs", build_stairs_view},
      {"depth_boxes", build_boxes_view},
      {"depth_slopes", build_slopes_view},
      {"depth_descent", build_descent_view},
  };
  return builds.at(set);
}

}  // namespace planescope::lab
