#pragma once

// Where the camera was: trajectories, and the files that other tools keep them in.

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
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

}  // namespace planescope::world
