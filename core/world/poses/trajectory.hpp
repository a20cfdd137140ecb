#pragma once

// Where the camera was: trajectories, and the files that other tools keep them in.

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

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

/// TUM (`timestamp tx ty tz qx qy qz qw`), KITTI (twelve numbers a line), Open3D's .log and .json
/// (PinholeCameraTrajectory), told apart by content. Throws Error naming the file and the line.
Trajectory read_trajectory(const std::filesystem::path& path);

/// TUM. What TUM has no place for (frame, segment, quality) stands in comments, which
/// read_trajectory() reads again; numbers as they are, to the bit. The
/// poses are settled.
std::string tum_text(const Trajectory& trajectory);

/// Of each of the frames its pose, none where the trajectory has none for it: by the frame's
/// number, by time (the nearest, no farther than half the usual distance between poses,
/// interpolated from no others), or by order, of which there must then be as many as frames, or as
/// the recording has. Throws Error where no frame gets a pose.
struct FrameTime {
  int frame = 0;
  double timestamp_s = 0;
};
std::vector<std::optional<CameraPose>> poses_of_frames(const Trajectory& trajectory,
                                                       const std::vector<FrameTime>& frames,
                                                       int recorded = 0);

}  // namespace planescope::world
