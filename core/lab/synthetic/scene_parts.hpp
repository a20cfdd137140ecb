#pragma once

// What scenes are put together from: corners of faces for add_polygon(), and things of several
// faces. x forward, y left, z up [m].

#include <span>
#include <vector>

#include "core/lab/synthetic/scene.hpp"

namespace planescope::lab {

struct Range {
  double low = 0, high = 0;
  double size() const { return high - low; }
};

/// A rectangle that faces up.
std::vector<Vec3d> level(const Range& x, const Range& y, double z);
/// A rectangle that stands on the way from a to b and faces its right-hand side.
std::vector<Vec3d> upright(const Vec2d& a, const Vec2d& b, const Range& z);

/// Level ground at z = 0 as one plane, apart from what stands on it.
struct Footprint {
  Range x, y;
};
void add_ground(Scene& scene, const Footprint& whole, std::span<const Footprint> holes = {});

/// Riser, tread, riser, ... going up along x.
struct Steps {
  double x = 0;  // of the first riser
  Range y;
  int count = 0;
  double length_m = 0, height_m = 0;
  double end() const { return x + count * length_m; }
  double top() const { return count * height_m; }
};
void add_steps(Scene& scene, const Steps& steps);
/// Both sides of steps that are solid down to the ground, each one plane.
void add_flanks(Scene& scene, const Steps& steps);

/// A ramp up along x, on to a level landing (none where that is 0), its sides and back.
struct Ramp {
  double x = 0;
  Range y;
  double run_m = 0, rise_m = 0, landing_m = 0;
  double top() const { return x + run_m; }
  double end() const { return x + run_m + landing_m; }
};
void add_ramp(Scene& scene, const Ramp& ramp);

/// Everything so far, about the vertical through a point.
void turn(Scene& scene, const Vec3d& center, double angle_deg);

}  // namespace planescope::lab
