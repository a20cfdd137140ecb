// Synthetic scenes: hand-made ones by name, and random compositions from a seed.

#include "core/lab/synthetic/scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/lab/synthetic/repeatable.hpp"
#include "core/model/error.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {

// ---- Named scenes ----

namespace {

const Material kFloorboards{{0.42, 0.27, 0.15}, Texture::planks};
const Material kConcrete{{0.52, 0.51, 0.48}, Texture::concrete};
const Material kPaleConcrete{{0.68, 0.66, 0.61}, Texture::concrete};
const Material kAsphalt{{0.13, 0.135, 0.145}, Texture::asphalt};
const Material kPlaster{{0.74, 0.71, 0.63}, Texture::plain};
const Material kBluePlaster{{0.45, 0.55, 0.62}, Texture::plain};
const Material kBrick{{0.47, 0.20, 0.13}, Texture::brick};
const Material kCardboard{{0.55, 0.38, 0.21}, Texture::cardboard};
const Material kDarkCardboard{{0.40, 0.25, 0.13}, Texture::cardboard};
const Material kTealBox{{0.10, 0.38, 0.38}, Texture::plain};
const Material kRubber{{0.62, 0.42, 0.06}, Texture::rubber};
const Material kEnamel{{0.16, 0.30, 0.48}, Texture::plain};

/// Random numbers that vary a scene, in sequence from its seed.
struct Variation {
  std::uint64_t seed = 0;
  std::uint64_t next = 0;

  double between(double low, double high) {
    return low + (high - low) * random_uniform(seed, 0x5ce4e, next++);
  }
  double about(double value) { return value * between(0.96, 1.04); }
  CameraPose camera(double y_m, double height_m, double yaw_deg, double pitch_deg) {
    CameraPose pose;
    pose.position = Vec3d(0, y_m, height_m + between(-0.04, 0.04));
    pose.yaw_deg = yaw_deg + between(-4, 4);
    pose.pitch_deg = pitch_deg + between(-2.5, 2.5);
    pose.roll_deg = between(-4, 4);
    return pose;
  }
};

/// z = height over [x0, x1] x [y0, y1], facing up.
int add_level(Scene& scene,
              double x0,
              double x1,
              double y0,
              double y1,
              double z,
              const Material& material,
              int plane = 0) {
  return add_polygon(scene, level({x0, x1}, {y0, y1}, z), material, plane);
}

/// x = const, facing the camera (-x).
void add_front(
    Scene& scene, double x, double y0, double y1, double z0, double z1, const Material& material) {
  add_polygon(scene, upright({x, y1}, {x, y0}, {z0, z1}), material);
}

/// y = const on the left, facing right (-y).
void add_left(
    Scene& scene, double y, double x0, double x1, double z0, double z1, const Material& material) {
  add_polygon(scene, upright({x0, y}, {x1, y}, {z0, z1}), material);
}

/// Four treads between a wall and an open side; the last one is a landing before a wall.
void build_stairs(Scene& scene, Variation& vary) {
  constexpr int kTreads = 4;
  const double rise = vary.about(0.15), going = vary.about(0.25);
  const double first = vary.about(0.68), left = vary.about(0.52), right = -vary.about(0.44);
  const double back = first + 3 * going + 0.9;
  add_level(scene, -1, back, -2.5, left, 0, kFloorboards);
  for (int i = 0; i < kTreads; ++i) {
    const double x = first + i * going, z = rise * (i + 1);
    const double end = i + 1 < kTreads ? x + going : back;
    add_front(scene, x, right, left, z - rise, z, kPaleConcrete);
    add_level(scene, x, end, right, left, z, kConcrete);
  }
  // The open side is one plane, in strips as high as their steps.
  int flank = 0;
  for (int i = 0; i < kTreads; ++i) {
    const double x = first + i * going, z = rise * (i + 1);
    const double end = i + 1 < kTreads ? x + going : back;
    flank = add_polygon(scene, {{x, right, 0}, {end, right, 0}, {end, right, z}, {x, right, z}},
                        kPaleConcrete, flank);
  }
  add_left(scene, left, -1, back, 0, 2.6, kPlaster);
  add_front(scene, back, -2.5, left, 0, 2.6, kBluePlaster);
  scene.camera = vary.camera(-0.05, 0.92, 3, 32);
}

/// A road, a kerb of 12 cm with a ramp against it, the pavement and a garden wall.
void build_kerb(Scene& scene, Variation& vary) {
  const double height = 0.12, kerb = vary.about(0.86), wall = kerb + vary.about(0.52);
  const double kerb_stone = 0.13, wide = 3, wall_height = vary.about(0.55);
  add_level(scene, -1, kerb, -wide, wide, 0, kAsphalt);
  add_front(scene, kerb, -wide, wide, 0, height, kPaleConcrete);
  const int pavement =
      add_level(scene, kerb, kerb + kerb_stone, -wide, wide, height, kPaleConcrete);
  add_level(scene, kerb + kerb_stone, wall, -wide, wide, height, kConcrete, pavement);
  add_front(scene, wall, -wide, wide, height, height + wall_height, kBrick);
  add_level(scene, wall, wall + 0.24, -wide, wide, height + wall_height, kPaleConcrete);
  add_front(scene, wall + 2.5, -2 * wide, 2 * wide, 0, 4, kPlaster);

  const double run = 0.45, right = -vary.about(0.52), left = right + vary.about(0.6);
  const Vec3d toe_l(kerb - run, left, 0), toe_r(kerb - run, right, 0);
  const Vec3d top_l(kerb, left, height), top_r(kerb, right, height);
  add_polygon(scene, {toe_r, top_r, top_l, toe_l}, kRubber);
  add_polygon(scene, {toe_l, top_l, {kerb, left, 0}}, kRubber);
  add_polygon(scene, {toe_r, {kerb, right, 0}, top_r}, kRubber);
  scene.camera = vary.camera(0.08, 0.82, -4, 35);
}

/// A ramp of 15 degrees up to a platform along a wall, with the floor beside it.
void build_ramp(Scene& scene, Variation& vary) {
  const double start = vary.about(0.52), run = 0.75, rise = run * sin_deg(15) / cos_deg(15);
  const double right = -vary.about(0.02), left = right + vary.about(0.7), back = start + run + 0.34;
  const double top = start + run;
  add_level(scene, -1, back, -2.5, left, 0, kConcrete);
  add_polygon(scene, {{start, right, 0}, {top, right, rise}, {top, left, rise}, {start, left, 0}},
              kFloorboards);
  add_level(scene, top, back, right, left, rise, kFloorboards);
  const int side =
      add_polygon(scene, {{start, right, 0}, {top, right, 0}, {top, right, rise}}, kPaleConcrete);
  add_polygon(scene, {{top, right, 0}, {back, right, 0}, {back, right, rise}, {top, right, rise}},
              kPaleConcrete, side);
  add_left(scene, left, -1, back, 0, 2.6, kBrick);
  add_front(scene, back, -2.5, left, 0, 2.6, kPlaster);
  scene.camera = vary.camera(-0.2, 0.84, 5, 33);
}

/// Boxes of several heights and orientations on a floor before a wall.
void build_boxes(Scene& scene, Variation& vary) {
  const double wall = vary.about(1.5);
  add_level(scene, -1, wall, -2.5, 2.5, 0, kFloorboards);
  add_front(scene, wall, -2.5, 2.5, 0, 2.6, kPlaster);
  const auto box = [&](double x, double y, const Vec3d& size, double yaw_deg, const Material& m) {
    // One statement at a time, because the evaluation order of arguments is unspecified.
    const double scale = vary.between(0.95, 1.05);
    const double turn_deg = vary.between(-5, 5);
    add_box(scene, Vec3d(x, y, 0), scale * size, yaw_deg + turn_deg, m);
  };
  box(0.86, 0.24, Vec3d(0.26, 0.36, 0.14), 18, kCardboard);
  box(1.20, 0.50, Vec3d(0.28, 0.30, 0.42), -8, kDarkCardboard);
  box(0.92, -0.28, Vec3d(0.22, 0.30, 0.26), -24, kTealBox);
  box(1.28, -0.06, Vec3d(0.24, 0.34, 0.20), 9, kCardboard);
  box(1.24, -0.62, Vec3d(0.30, 0.34, 0.34), 12, kDarkCardboard);
  scene.camera = vary.camera(0, 0.86, 0, 34);
}

/// Two walls that meet in a corner, a floor, a bin (curved, so without a plane) and a low box.
void build_corner(Scene& scene, Variation& vary) {
  const double back = vary.about(1.35), left = vary.about(0.42);
  add_level(scene, -1, back, -3, left, 0, kConcrete);
  add_front(scene, back, -3, left, 0, 2.6, kPlaster);
  add_left(scene, left, -1, back, 0, 2.6, kBluePlaster);
  add_cylinder(scene, Vec3d(1.1, 0.16, 0), 0.12, vary.about(0.3), kEnamel);
  add_box(scene, Vec3d(1.05, -0.42, 0), Vec3d(0.3, 0.34, 0.1), vary.between(-20, 20), kCardboard);
  scene.camera = vary.camera(-0.25, 0.84, 12, 31);
}

struct NamedScene {
  const char* name;
  void (*build)(Scene&, Variation&);
};
constexpr std::array kScenes = {NamedScene{"stairs", build_stairs}, NamedScene{"kerb", build_kerb},
                                NamedScene{"ramp", build_ramp}, NamedScene{"boxes", build_boxes},
                                NamedScene{"corner", build_corner}};

}  // namespace

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const NamedScene& scene : kScenes) all.emplace_back(scene.name);
    return all;
  }();
  return names;
}

Scene make_scene(const std::string& name, std::uint64_t seed) {
  std::string known;
  for (const NamedScene& named : kScenes) {
    if (name == named.name) {
      Scene scene;
      scene.name = name;
      Variation vary{seed};
      named.build(scene, vary);
      return scene;
    }
    known += (known.empty() ? "" : ", ") + std::string(named.name);
  }
  throw Error("unknown scene \"" + name + "\"; expected one of " + known);
}

// ---- Composed scenes ----

namespace {

/// A convex outline in x-z, counter-clockwise seen from -y, extruded from y = right to y = left.
struct Prism {
  std::vector<Vec2d> outline;
  double right = 0, left = 0;
};

/// Adds surfaces to a scene, rotated about the vertical through a point.
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

  /// All faces of a prism except those on the floor.
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
/// Range of an object of this width near the middle of the view.
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
  // Rotated about its front point, so that its distance from the camera stays the same.
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
