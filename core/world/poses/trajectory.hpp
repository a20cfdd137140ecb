#pragma once

// Where the camera was: trajectories, the files that other tools keep them in, and odometry, which
// estimates them from depth and color alone.

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
#include "core/model/types.hpp"

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

}  // namespace planescope::world
