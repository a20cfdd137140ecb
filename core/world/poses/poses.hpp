#pragma once

// Where the camera was, and what is down: trajectories, the files that other tools keep them in,
// odometry, which estimates them from depth and color alone, and gravity over a recording: one
// direction for all frames whose poses are known, that of a neighbor for frames that show too
// little.

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/labels/review/carry.hpp"
#include "core/model/frame.hpp"
#include "core/model/types.hpp"
#include "core/planes/cloud/gravity.hpp"

namespace planescope::world {

/// Camera axes: x right, y down, z forward.
struct CameraPose {
  int frame = -1;          // number in the recording; -1: the file tells a time instead
  double timestamp_s = 0;  // as the recording has it; NaN: the file tells an order alone
  Pose T_world_camera = Pose::Identity();
  /// Its rotation, as files have it (x y z w); all zero: not settled yet. What is written and read
  /// again is the same to the bit, as the matrix then follows from it.
  std::array<double, 4> quaternion{};
  /// Poses of different segments have worlds of their own: nobody knows the motion between them.
  int segment = 0;
  // What odometry says of the motion that led here; NaN: nothing.
  double fitness = std::numeric_limits<double>::quiet_NaN();  // share of points with a partner
  double rms_m = std::numeric_limits<double>::quiet_NaN();    // of partners, across the surface
};

struct Trajectory {
  std::string source;  // for people: a file, "odometry", ...
  std::vector<CameraPose> poses;
  bool estimated = false;  // from the frames themselves
};

/// Null: it has none. Of poses whose frames ascend.
const CameraPose* pose_of(const Trajectory& trajectory, int frame);

/// By how much a motion turns, 0 to 180.
double turn_deg(const Pose& motion);

/// Takes the quaternion of the pose, where it has none yet, and the pose's rotation from it.
void settle(CameraPose& pose);

/// How far a pose may be from the first one of its trajectory [m]. A camera that goes farther is a
/// wrong unit or a damaged number, and cells of its planes could not be counted.
inline constexpr double kFarthestPose_m = 100e3;
/// How far a pose may be from the world's origin [m]: enough for coordinates about Earth's center.
inline constexpr double kFarthestFromOrigin_m = 100e6;
/// Empty, or what of the pose is beyond these limits: "1e+09 m from the first pose; ...".
std::string too_far(const Pose& pose, const Pose& first);

/// TUM (`timestamp tx ty tz qx qy qz qw`), KITTI (twelve numbers a line), Open3D's .log and .json
/// (PinholeCameraTrajectory), told apart by content. Throws Error naming the file and the line
/// (entry of a .json) where a pose is damaged or too far, or two of one time or frame differ.
Trajectory read_trajectory(const std::filesystem::path& path);

/// TUM. What TUM has no place for (frame, segment, quality) stands in comments, which
/// read_trajectory() reads again; numbers as they are, to the bit. The
/// poses are settled.
std::string tum_text(const Trajectory& trajectory);

/// Whether the recording tells when its frames were taken: the time of some frame is not 0.
bool frames_have_times(const io::Recording& recording);

struct PairedPoses {
  /// Of the frames asked for, in their order, with the frames' numbers and times; nullopt where the
  /// trajectory has no pose for the frame.
  std::vector<std::optional<CameraPose>> poses;
  std::string notice;  // for people, where poses were paired by order, or against their numbers
};

/// When a frame was taken [s]; NaN if its time cannot be read.
double time_of(const io::Recording& recording, int frame);

/// Which pose belongs to which frame:
/// - by the frame's number, where every pose has one and no time contradicts it;
/// - by time, the nearest and no farther than half the usual distance between poses;
/// - by order, where frames or poses have no times: as many poses as the recording has frames, or,
///   where the poses have no times, as many as `frames`. Frames without times get the poses'.
/// Throws Error naming the trajectory where no frame gets a pose, the counts differ, or two frames
/// are nearest to one pose. `frames`: ascending numbers, at least one.
PairedPoses pair_poses(const Trajectory& trajectory,
                       const io::Recording& recording,
                       std::span<const int> frames);

// ---- Odometry ----

struct OdometryOptions {
  // A frame is registered with the last key frame; it becomes one where it overlaps less than
  // this, or is farther off.
  double key_fitness = 0.75;
  double key_distance_m = 0.25, key_angle_deg = 12;
  // A motion is believed where so many points found partners, and it is none that a camera makes
  // from one frame to the next.
  double least_fitness = 0.4;
  double most_step_m = 0.4, most_step_deg = 25;
  // Key frames that came near each other again are registered as well.
  bool loops = true;
  double loop_distance_m = 0.5, loop_angle_deg = 30, loop_fitness = 0.6;
  int loop_gap = 5;  // key frames between them, at least
};

struct OdometryJob {
  const io::Recording* recording = nullptr;
  std::vector<int> frames;
  OdometryOptions options;
  int threads = 1;
  std::function<void(int done, int all)> progress = {};
  std::stop_token stop = {};
};

/// The first frame of each segment is at its origin, its camera's axes those of the world. Frames
/// that cannot be read have no pose. The same bits for any number of threads.
Trajectory estimate_trajectory(const OdometryJob& job);

// The motion between two frames: labels::register_frames(), and how far to believe it.

/// A frame as it is registered. Null where it cannot be read or hardly anything is measured.
std::shared_ptr<const labels::LabelGrid> registration_grid(const io::Recording& recording,
                                                           int frame,
                                                           bool color);

/// Whether enough points found partners, and a camera can move by `step` in so many frames.
bool is_credible(const labels::Registration& found,
                 const Pose& step,
                 double frames = 1,
                 const OdometryOptions& options = {});

/// Registration::information, less than the sum over partners: neighbors err alike.
Eigen::Matrix<double, 6, 6> effective_information(const labels::Registration& registration);

// ---- Poses from motions between them that do not quite agree (Grisetti et al. 2010) ----

using Mat6d = Eigen::Matrix<double, 6, 6>;

/// A measured motion: T_from_to takes points of `to` into `from`. Errors are a small turn about the
/// axes of `to` and a shift along them, rotation first.
struct PoseEdge {
  int from = 0, to = 0;
  Pose T_from_to = Pose::Identity();
  Mat6d information = Mat6d::Identity();
  bool loop = false;  // may be wrong: counts less the farther off it is (Cauchy)
};

/// Least squares over all edges by Gauss-Newton; the first pose stays. `T_world_pose`: where to
/// start. What no edge leads to stays as well.
void optimise_poses(std::vector<Pose>& T_world_pose, const std::vector<PoseEdge>& edges);

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
