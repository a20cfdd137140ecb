#include "core/world/map_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/sha256.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/world/map_pass.hpp"
#include "core/world/poses/odometry.hpp"

namespace planescope::world {
namespace {

constexpr int kGravityFrames = 60;  // looked at, spread over the recording
constexpr double kLeastKept = 0.2;  // share of pixels on planes that go on in the next frame

/// The poses that the frames carry; empty where none does.
Trajectory own_trajectory(const MapJob& job) {
  Trajectory own{"the recording", {}};
  for (const int index : job.frames) {
    const std::optional<Pose> pose = job.recording->T_world_camera(index);
    if (!pose) continue;
    own.poses.push_back({.frame = index,
                         .timestamp_s = job.recording->timestamp_s(index),
                         .T_world_camera = *pose});
    if (const std::string far = too_far(*pose, own.poses[0].T_world_camera); !far.empty())
      throw Error(fmt::format("{}: the pose of frame {} is {}", job.recording->info().path.string(),
                              index, far));
  }
  return own;
}

/// One pose each for frames of this job, in their order.
Trajectory trajectory_of(const MapJob& job, std::vector<std::string>& told) {
  if (job.trajectory) {
    const PairedPoses paired = pair_poses(*job.trajectory, *job.recording, job.frames);
    if (!paired.notice.empty()) told.push_back(paired.notice);
    Trajectory given{job.trajectory->source, {}};
    for (const std::optional<CameraPose>& pose : paired.poses)
      if (pose) given.poses.push_back(*pose);
    return given;
  }
  if (Trajectory own = own_trajectory(job); !own.poses.empty()) return own;
  if (job.at_own_rate)
    throw Error(job.recording->info().path.string() +
                ": has no poses, expected them where frames are taken at their own rate: odometry "
                "does not keep up");
  OdometryJob odometry;
  odometry.recording = job.recording;
  odometry.frames = job.frames;
  odometry.threads = job.threads;
  odometry.stop = job.stop;
  odometry.progress = [&](int done, int all) { tell(job, "odometry", done, all); };
  Trajectory found = estimate_trajectory(odometry);
  const int segments = found.poses.empty() ? 0 : found.poses.back().segment + 1;
  if (segments > 1)
    told.push_back(fmt::format("odometry lost its way: {}, each with a world of its own",
                               counted(segments, "segment")));
  return found;
}

int looked_at(const Trajectory& trajectory, int most) {
  return std::min(static_cast<int>(trajectory.poses.size()), most);
}

/// visit(0, pose) to visit(looked - 1, pose) of frames spread over the recording, side by side;
/// what cannot be read is told where the frame's turn comes.
void look_at_some(const MapJob& job,
                  const Trajectory& trajectory,
                  int looked,
                  const char* what,
                  const std::function<void(int, const CameraPose&)>& visit) {
  const std::size_t count = trajectory.poses.size();
  work_through(
      looked, job.threads,
      [&](int i) {
        if (job.stop.stop_requested()) return;
        try {
          visit(i, trajectory.poses[static_cast<std::size_t>(i) * count / looked]);
        } catch (const Error&) {
        }
      },
      [&](int done, int all) {
        check_stop(job);
        tell(job, what, done, all);
      });
}

/// Gravity of frames spread over each segment.
std::vector<SharedGravity> turn_upright_by_frames(const MapJob& job, Trajectory& trajectory) {
  const int looked = looked_at(trajectory, kGravityFrames);
  std::vector<GravitySample> samples(looked);
  std::vector<int> segments(looked);
  planes::GravityOptions options = job.pipeline.gravity;
  options.none_where_unknown = true;
  look_at_some(job, trajectory, looked, "gravity", [&](int i, const CameraPose& pose) {
    segments[i] = pose.segment;
    samples[i].T_world_camera = pose.T_world_camera;
    samples[i].gravity = planes::unknown_gravity({}, "cannot be read");
    const Frame frame = job.recording->frame(pose.frame);
    samples[i].gravity = planes::resolve_gravity(frame, options);
  });
  return turn_upright(trajectory, samples, segments);
}

void tell_of_aside(const Tracker& tracker, std::vector<std::string>& told) {
  int aside = 0, first = -1;
  for (const FrameOfTracks& frame : tracker.frames())
    if (frame.set_aside) {
      if (aside++ == 0) first = frame.frame;
    }
  if (aside > 0)
    told.push_back(fmt::format(
        "{} set aside, from frame {} on: at their poses, their depth does not fit what was seen "
        "before",
        counted(aside, "frame"), first));
  const auto& frames = tracker.frames();
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (frames[i].segment != frames[i - 1].segment)
      told.push_back(fmt::format("a new segment of the map begins at frame {}", frames[i].frame));
}

}  // namespace

planes::PipelineOptions options_of_map(planes::PipelineOptions options) {
  if (options.gravity.mode != planes::GravityMode::none)
    options.gravity.mode = planes::GravityMode::automatic;
  options.gravity.none_where_unknown = true;
  return options;
}

planes::PipelineOptions turn_to_map(Frame& frame,
                                    planes::PipelineOptions options,
                                    const CameraPose& pose,
                                    const UprightPoses& upright) {
  frame.timestamp_s = pose.timestamp_s;  // its own, or where it has none the pose's
  const SharedGravity& gravity = upright.gravity[static_cast<std::size_t>(pose.segment)];
  if (gravity.known && options.gravity.mode != planes::GravityMode::none)
    frame.gravity = gravity_at(pose.T_world_camera, gravity);
  return options_of_map(std::move(options));
}

namespace {

UprightPoses upright_poses(const MapJob& job) {
  const std::string path = job.recording->info().path.string();
  if (job.recording->info().width == 0)
    throw Error(path + ": holds clouds, expected depth images: a map follows a camera");
  UprightPoses upright;
  upright.poses = trajectory_of(job, upright.told);
  std::vector<CameraPose>& poses = upright.poses.poses;
  if (poses.empty()) throw Error(path + ": no frame has a pose");
  const auto back = std::ranges::is_sorted_until(poses, {}, &CameraPose::timestamp_s);
  if (back != poses.end())
    upright.told.push_back(
        fmt::format("time goes back at frame {}: frames are taken in their order", back->frame));
  upright.gravity = turn_upright_by_frames(job, upright.poses);
  for (CameraPose& pose : poses) settle(pose);
  return upright;
}

}  // namespace

std::string pipeline_key(const planes::PipelineOptions& options) {
  std::string text;
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.matters(options) && info.section != "foot" && info.section != "stairs")
      text += info.name + "=" + info.get(options) + "\n";
  return sha256_hex(text);
}

namespace {

/// The poses become those at which the tracker has the frames.
void take_aligned(const Tracker& tracker, std::vector<CameraPose>& poses) {
  auto pose = poses.begin();
  for (const FrameOfTracks& frame : tracker.frames()) {
    if (!frame.has_pose) continue;
    while (pose->frame != frame.frame) ++pose;
    pose->T_world_camera = frame.T_world_camera;
    pose->quaternion = {};
    settle(*pose);
  }
}

}  // namespace

WorldMap map_recording(const MapJob& job) {
  WorldMap map;
  map.pipeline_key = pipeline_key(job.pipeline);
  static_cast<UprightPoses&>(map) = upright_poses(job);
  const bool helps = !job.alone && planes::finds_on_pixels(job.pipeline);
  const bool in_one_pass = job.at_own_rate || job.tracks.window_m > 0;
  Pass pass = pass_through(job, map, helps && in_one_pass ? Offer::so_far : Offer::nothing, nullptr,
                           "map", !helps || in_one_pass);
  take_aligned(pass.tracker, map.poses.poses);
  if (helps && !in_one_pass) {
    Tracker earlier = std::move(pass.tracker);
    earlier.consolidate();
    pass = pass_through(job, map, Offer::all, &earlier, "second pass", true);
  }
  map.tracker = std::move(pass.tracker);
  map.stored = std::move(pass.stored);
  map.pace = pass.pace;
  map.refused = static_cast<int>(pass.refused.size());
  std::ranges::move(pass.refused, std::back_inserter(map.told));
  if (pass.without_pose > 0)
    map.told.push_back(fmt::format("{} of {} have no pose and are left out", pass.without_pose,
                                   counted(job.frames.size(), "frame")));
  tell_of_aside(map.tracker, map.told);
  map.stability = stability_of(map.tracker, map.poses.poses);
  if (map.stability.kept_share < kLeastKept)
    map.told.push_back(
        fmt::format("only {:.0f} % of pixels on planes go on in the next frame: frames may be too "
                    "far apart, or "
                    "the poses of {} not those of a camera in the world, in metres",
                    100 * map.stability.kept_share, map.poses.source));
  return map;
}

void observe_recording(const MapJob& job,
                       const std::function<bool(std::size_t position)>& is_mine,
                       const std::function<void(const ObservedFrame&, const UprightPoses&)>& take) {
  if (!job.trajectory && own_trajectory(job).poses.empty())
    throw Error(
        job.recording->info().path.string() +
        ": has no poses, expected them for a part of the frames: odometry goes through all");
  const UprightPoses upright = upright_poses(job);
  std::vector<const CameraPose*> mine;
  const std::vector<const CameraPose*> all = poses_by_frame(job, upright);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i] && is_mine(i)) mine.push_back(all[i]);
  observe_each(job, upright, mine, [&](const ObservedFrame* seen) {
    if (seen) take(*seen, upright);
  });
}

}  // namespace planescope::world
