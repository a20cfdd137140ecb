#pragma once

// Camera poses and gravity of recordings: trajectories and their file formats; odometry from depth
// and color; and gravity over a recording, either one direction for all frames with known poses, or
// the direction of a neighboring frame for frames that show too little.

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
  int frame = -1;          // index in the recording; -1: the file contains times instead
  double timestamp_s = 0;  // as recorded; NaN: the file contains only an order
  Pose T_world_camera = Pose::Identity();
  /// Rotation as in files (x y z w); all zero: not settled yet. The matrix is derived from the
  /// quaternion, so writing and reading a pose is bit-exact.
  std::array<double, 4> quaternion{};
  /// Poses of different segments are in different worlds with unknown relative motion.
  int segment = 0;
  // Quality of the odometry step to this pose; NaN: unknown.
  double fitness = std::numeric_limits<double>::quiet_NaN();  // share of points with a partner
  double rms_m = std::numeric_limits<double>::quiet_NaN();    // of partners, perpendicular to
                                                              // the surface
};

struct Trajectory {
  std::string source;  // shown to users: a file, "odometry", ...
  std::vector<CameraPose> poses;
  bool estimated = false;  // from the frames themselves
};

/// Null if there is none. Frames of the poses must ascend.
const CameraPose* pose_of(const Trajectory& trajectory, int frame);

/// Rotation angle of a motion, 0 to 180 degrees.
double turn_deg(const Pose& motion);

/// Sets the quaternion from the pose if missing, then the pose's rotation from the quaternion.
void settle(CameraPose& pose);

/// Largest distance of a pose from the first pose of its trajectory [m]. A larger one indicates a
/// wrong unit or a damaged number, and would overflow the cell indices of planes.
inline constexpr double kFarthestPose_m = 100e3;
/// Largest distance of a pose from the world's origin [m]: sufficient for Earth-centered
/// coordinates.
inline constexpr double kFarthestFromOrigin_m = 100e6;
/// Describes how the pose exceeds these limits, "1e+09 m from the first pose; ..."; empty if it
/// does not.
std::string too_far(const Pose& pose, const Pose& first);

/// Reads TUM (`timestamp tx ty tz qx qy qz qw`), KITTI (twelve numbers per line), and Open3D's .log
/// and .json (PinholeCameraTrajectory), distinguished by content. Throws Error naming the file and
/// the line (or the entry of a .json) if a pose is damaged or too far, or if two poses for the same
/// time or frame differ.
Trajectory read_trajectory(const std::filesystem::path& path);

/// TUM format. Frame, segment and quality are stored in comments, which read_trajectory() parses.
/// Numbers are written bit-exactly. The poses must be settled.
std::string tum_text(const Trajectory& trajectory);

/// Whether the recording has times: the time of some frame is not 0.
bool frames_have_times(const io::Recording& recording);

struct PairedPoses {
  /// One entry per requested frame, in order, with the frame's index and time; nullopt if the
  /// trajectory has no pose for it.
  std::vector<std::optional<CameraPose>> poses;
  std::string notice;  // user notice if poses were paired by order, or against their indices
};

/// Time of a frame [s]; NaN if unreadable.
double time_of(const io::Recording& recording, int frame);

/// Assigns poses to frames:
/// - by frame index, if every pose has one and no time contradicts it;
/// - by time, the nearest pose within half the usual distance between poses;
/// - by order, if frames or poses have no times: requires as many poses as frames in the recording
///   or, if the poses have no times, as many as `frames`. Frames without times get the poses'.
/// Throws Error naming the trajectory if no frame gets a pose, the counts differ, or two frames are
/// nearest to the same pose. `frames`: ascending indices, at least one.
PairedPoses pair_poses(const Trajectory& trajectory,
                       const io::Recording& recording,
                       std::span<const int> frames);

// ---- Odometry ----

struct OdometryOptions {
  // Frames are registered with the last key frame. A frame becomes a key frame if it overlaps less
  // or is farther away.
  double key_fitness = 0.75;
  double key_distance_m = 0.25, key_angle_deg = 12;
  // A motion is accepted if enough points have partners and it is plausible between
  // successive frames.
  double least_fitness = 0.4;
  double most_step_m = 0.4, most_step_deg = 25;
  // Key frames that meet again are registered as well.
  bool loops = true;
  double loop_distance_m = 0.5, loop_angle_deg = 30, loop_fitness = 0.6;
  int loop_gap = 5;  // smallest number of key frames between them
};

struct OdometryJob {
  const io::Recording* recording = nullptr;
  std::vector<int> frames;
  OdometryOptions options;
  int threads = 1;
  std::function<void(int done, int all)> progress = {};
  std::stop_token stop = {};
};

/// The first frame of each segment is the origin, with its camera axes as the world axes.
/// Unreadable frames have no pose. Bit-identical for any number of threads.
Trajectory estimate_trajectory(const OdometryJob& job);

// Motion between two frames: labels::register_frames(), and its reliability.

/// A frame prepared for registration. Null if it is unreadable or has almost no measurements.
std::shared_ptr<const labels::LabelGrid> registration_grid(const io::Recording& recording,
                                                           int frame,
                                                           bool color);

/// Whether enough points have partners, and a camera can move by `step` within this many frames.
bool is_credible(const labels::Registration& found,
                 const Pose& step,
                 double frames = 1,
                 const OdometryOptions& options = {});

/// Registration::information, reduced because errors of neighbors are correlated.
Eigen::Matrix<double, 6, 6> effective_information(const labels::Registration& registration);

// ---- Pose graph optimization (Grisetti et al. 2010) ----

using Mat6d = Eigen::Matrix<double, 6, 6>;

/// A measured motion: T_from_to maps points from `to` to `from`. Errors are a small rotation about
/// the axes of `to` and a translation along them, rotation first.
struct PoseEdge {
  int from = 0, to = 0;
  Pose T_from_to = Pose::Identity();
  Mat6d information = Mat6d::Identity();
  bool loop = false;  // may be wrong: weight decreases with the error (Cauchy)
};

/// Gauss-Newton least squares over all edges. The first pose and unconnected poses stay fixed.
/// `T_world_pose`: initial values, replaced by the result.
void optimise_poses(std::vector<Pose>& T_world_pose, const std::vector<PoseEdge>& edges);

// ---- One direction of gravity for a whole recording ----
// Estimates of single frames err by half a degree or more; the camera's motion relates them.

/// Gravity of a frame, at a pose.
struct GravitySample {
  Pose T_world_camera = Pose::Identity();
  Gravity gravity;  // direction in the camera frame
};

struct SharedGravity {
  bool known = false;
  Vec3d direction = Vec3d(0, 0, -1);           // unit, in the world frame of the poses
  double spread_deg = 0;                       // median angle of the samples from it
  int samples = 0, strays = 0;                 // strays: more than kStray spreads away, ignored
  GravitySource source = GravitySource::none;  // least reliable source of the samples used
};

/// Samples with unknown gravity are ignored.
SharedGravity shared_gravity(std::span<const GravitySample> samples);

/// Rotates each segment's world so that z opposes its gravity. Worlds already upright within
/// kUpright degrees are kept bit-exactly. Returns the gravity of each segment.
std::vector<SharedGravity> turn_upright(Trajectory& trajectory,
                                        std::span<const GravitySample> samples,
                                        std::span<const int> segments);

/// Gravity of a frame in an upright world (z up).
Gravity gravity_at(const Pose& T_world_camera, const SharedGravity& shared);

// ---- Gravity from a neighboring frame, by the camera's motion ----

/// Search range for gravity on either side, in frames. Picks apply farther if the recording
/// has poses.
inline constexpr int kMostFramesCarried = 30;

/// Estimates with lower confidence are replaced by a neighbor's. On tum_fr1_rpy, of 39 estimates
/// below 0.1, 33 were wrong by 90 degrees; those above were off by at most 6.4 degrees. Scenes with
/// walls only never exceed it.
inline constexpr double kSureGravity = 0.15;

/// Computes estimates and motions when a frame first needs them, and caches them. Thread-safe. The
/// result for a frame depends only on the recording, the options and the picks.
class SequenceGravity {
 public:
  /// `recording`: without picks. In modes other than `automatic`, for clouds and without
  /// intrinsics, frames get only their own picks.
  SequenceGravity(std::shared_ptr<const io::Recording> recording, planes::GravityOptions options);
  ~SequenceGravity();

  /// Sets Frame::gravity to the first available of: the frame's own gravity, a pick on it, the
  /// nearest pick on another frame, its own estimate if reliable, the nearest reliable estimate of
  /// another frame, its own estimate. Gravity from another frame has the source `carried` and a
  /// note naming that frame. Motion comes from the recording's poses or, without them, from depth
  /// odometry, which stops at unreliable registrations. Leaves gravity unset if none is available.
  void resolve(Frame& frame, const io::PickedGravity& picked = {}) const;

 private:
  struct Cache;
  std::unique_ptr<Cache> cache_;
};

}  // namespace planescope::world
