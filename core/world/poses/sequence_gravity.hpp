#pragma once

// Gravity over a recording: one direction for all frames whose poses are known, and for frames that
// show too little of it that of a neighbor.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/io/picked_gravity.hpp"
#include "core/io/recording.hpp"
#include "core/model/frame.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/world/poses/trajectory.hpp"

namespace planescope::world {

// ---- One direction for a whole recording ----
// Each frame's own errs by half a degree and more; the camera's motion tells how they belong
// together.

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

// ---- Taken from a neighbor and carried by the camera's motion ----

/// How far to either side gravity is searched for, in frames. A pick reaches farther where the
/// recording has poses.
inline constexpr int kMostFramesCarried = 30;

/// An estimate of less confidence is replaced by a neighbor's: over tum_fr1_rpy, those below 0.1
/// were wrong by 90 degrees 33 times of 39, those above never by more than 6.4. A scene of walls
/// alone never gets above it.
inline constexpr double kSureGravity = 0.15;

/// Estimates and motions are computed when a frame first needs them, and kept. Any thread may ask;
/// what a frame gets depends on nothing but the recording, the options and the picks.
class SequenceGravity {
 public:
  /// `recording`: without picks. With other modes than `automatic`, on clouds and without
  /// intrinsics, frames get what was picked for them and nothing else.
  SequenceGravity(std::shared_ptr<const io::Recording> recording, planes::GravityOptions options);
  ~SequenceGravity();

  /// Sets Frame::gravity of a frame of the recording to the first of: what it carries, what was
  /// picked on it, the nearest pick on another frame, its own estimate where that is sure, the
  /// nearest sure one of another frame, its own estimate. What comes from another frame has the
  /// source `carried` and a note that names the frame; motion is that of the recording's poses or,
  /// without them, of depth odometry, which ends where a registration is not to be believed.
  /// Leaves gravity unset where there is none of these.
  void resolve(Frame& frame, const io::PickedGravity& picked = {}) const;

 private:
  struct Cache;
  std::unique_ptr<Cache> cache_;
};

}  // namespace planescope::world
