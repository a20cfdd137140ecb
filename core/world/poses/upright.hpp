#pragma once

// One direction of gravity for a whole recording: each frame's own errs by half a degree and more,
// and the camera's motion tells how they belong together.

#include <span>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/world/poses/trajectory.hpp"

namespace planescope::world {

/// Gravity as a frame has it, at a pose.
struct GravitySample {
  Pose T_world_camera = Pose::Identity();
  Gravity gravity;  // direction in the camera's frame
};

struct SharedGravity {
  bool known = false;
  Vec3d direction = Vec3d(0, 0, -1);  // unit, in the world of the poses
  double spread_deg = 0;              // of the samples about it: their median angle
  int samples = 0, strays = 0;        // strays: more than kStray spreads off, they do not count
  GravitySource source = GravitySource::none;  // the worst of those that count
};

/// Those whose gravity is not known do not count.
SharedGravity shared_gravity(std::span<const GravitySample> samples);

/// Turns each segment's world upright, z against its gravity, unless it is already so within
/// kUpright degrees: a world that was given upright stays as it was given, to the bit. Returns what
/// was found, by segment.
std::vector<SharedGravity> turn_upright(Trajectory& trajectory,
                                        std::span<const GravitySample> samples,
                                        std::span<const int> segments);

/// The frame's gravity in a world whose z is up.
Gravity gravity_at(const Pose& T_world_camera, const SharedGravity& shared);

}  // namespace planescope::world
