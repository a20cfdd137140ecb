#pragma once

// Worlds of polygons, and their building blocks.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::lab {

inline constexpr double kFarM = 6;  // beyond the range of every view

/// Color texture of a surface; does not affect depth.
enum class Texture : std::uint8_t { plain, concrete, asphalt, planks, cardboard, brick, rubber };

struct Material {
  Vec3d albedo = Vec3d(0.7, 0.7, 0.7);  // linear RGB, 0..1
  Texture texture = Texture::plain;
};

/// A convex planar polygon in the world frame (x forward, y left, z up; meters), with corners
/// counter-clockwise seen from outside.
struct Surface {
  std::vector<Vec3d> corners;
  Vec3d normal = Vec3d::UnitZ();  // unit, outward
  int plane = 0;                  // true plane id from 1; 0: part of a curved surface
  Material material;
};

/// A piece of a true plane; several may share their plane.
struct TruePolygon {
  std::vector<Vec3d> corners;  // convex, [m]
  int plane = 0;               // id from 1; 0: part of a curved surface
};

/// The camera's pose. All angles 0: looking along +x, upright.
struct CameraPose {
  Vec3d position = Vec3d(0, 0, 0.8);  // [m]
  double yaw_deg = 0;                 // to the left
  double pitch_deg = 0;               // down
  double roll_deg = 0;                // clockwise, seen from behind the camera
};

/// A step of a scene's stairs: its nosing, seen when going up, and the planes before and behind it.
struct TrueStep {
  Vec3d right = Vec3d::Zero(), left = Vec3d::Zero();  // [m]
  int before = 0, tread = 0;                          // plane ids
};

/// The one flight of a scene: steps from the lowest.
struct TrueStairs {
  double rise_m = 0, going_m = 0, width_m = 0;
  bool seen_from_above = false;
  std::vector<TrueStep> steps;
};

/// A world of polygons. Gravity is -z.
struct Scene {
  std::string name;
  std::vector<Surface> surfaces;
  int planes = 0;                         // ids in use: 1..planes
  Vec3d light = Vec3d(-0.4, -0.5, 0.77);  // unit, towards the light
  CameraPose camera;                      // a pose with a good view of the scene
  std::optional<TrueStairs> stairs;
};

/// Sensor axes: x right, y down, z forward.
Pose pose_of(const CameraPose& camera);

/// Adds a polygon and returns its plane id: `plane` if it is positive (parts of one plane share
/// their id), else a new one. Curved surfaces have no id.
int add_polygon(Scene& scene, std::vector<Vec3d> corners, const Material& material, int plane = 0);
void add_curved(Scene& scene, std::vector<Vec3d> corners, const Material& material);

/// A box on z = base.z(): four sides and a top, each a separate plane. `base` is the center of its
/// bottom face, `size` along its own x, y, z, rotated by yaw.
void add_box(
    Scene& scene, const Vec3d& base, const Vec3d& size, double yaw_deg, const Material& material);

/// An upright cylinder: a curved wall without plane ids, and a flat lid with one.
void add_cylinder(
    Scene& scene, const Vec3d& base, double radius_m, double height_m, const Material& material);

// ---- Parts of scenes: corners of faces for add_polygon(), and objects with several faces ----

struct Range {
  double low = 0, high = 0;
  double size() const { return high - low; }
};

/// A rectangle facing up.
std::vector<Vec3d> level(const Range& x, const Range& y, double z);
/// An upright rectangle from a to b that faces the right side of that direction.
std::vector<Vec3d> upright(const Vec2d& a, const Vec2d& b, const Range& z);

/// Level ground at z = 0 as one plane, except under the objects on it.
struct Footprint {
  Range x, y;
};
void add_ground(Scene& scene,
                const Footprint& whole,
                std::span<const Footprint> holes = {},
                const Material& material = {});

/// Riser, tread, riser, ... going up along x.
struct Steps {
  double x = 0;  // of the first riser
  Range y;
  int count = 0;
  double length_m = 0, height_m = 0;
  double end() const { return x + count * length_m; }
  double top() const { return count * height_m; }
};
/// Returns the treads' planes.
std::vector<int> add_steps(Scene& scene, const Steps& steps);
/// Both sides of solid steps, each one plane.
void add_flanks(Scene& scene, const Steps& steps);

/// A ramp up along x to a level landing (none if its length is 0), with its sides and back.
struct Ramp {
  double x = 0;
  Range y;
  double run_m = 0, rise_m = 0, landing_m = 0;
  double top() const { return x + run_m; }
  double end() const { return x + run_m + landing_m; }
};
void add_ramp(Scene& scene, const Ramp& ramp);

/// Rotates everything added so far about the vertical through a point.
void turn(Scene& scene, const Vec3d& center, double angle_deg);

}  // namespace planescope::lab
