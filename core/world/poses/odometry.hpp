#pragma once

// The camera's path from depth and color alone: motions between frames, and poses that fit them
// best.

#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "core/io/recording.hpp"
#include "core/labels/review/carry.hpp"
#include "core/model/types.hpp"
#include "core/world/poses/trajectory.hpp"

namespace planescope::world {

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
