// Builds the map of a recording: poses, shared gravity, passes and tracks.

#include "core/world/map_recording.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::world {
namespace {

constexpr int kGravityFrames = 60;  // number of frames sampled per segment
constexpr double kLeastKept = 0.2;  // smallest share of pixels on planes that continue in the
                                    // next frame

/// Poses recorded with the frames; empty if there are none.
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

/// One pose each for frames of this job, in order.
Trajectory trajectory_of(const MapJob& job, std::vector<std::string>& warnings) {
  if (job.trajectory) {
    const PairedPoses paired = pair_poses(*job.trajectory, *job.recording, job.frames);
    if (!paired.notice.empty()) warnings.push_back(paired.notice);
    Trajectory given{job.trajectory->source, {}};
    for (const std::optional<CameraPose>& pose : paired.poses)
      if (pose) given.poses.push_back(*pose);
    return given;
  }
  if (Trajectory own = own_trajectory(job); !own.poses.empty()) return own;
  if (job.at_own_rate)
    throw Error(job.recording->info().path.string() +
                ": has no poses; specify them to process frames at the recording's rate, because "
                "odometry is too slow");
  OdometryJob odometry;
  odometry.recording = job.recording;
  odometry.frames = job.frames;
  odometry.threads = job.threads;
  odometry.stop = job.stop;
  odometry.progress = [&](int done, int all) { report_progress(job, "odometry", done, all); };
  Trajectory found = estimate_trajectory(odometry);
  const int segments = found.poses.empty() ? 0 : found.poses.back().segment + 1;
  if (segments > 1)
    warnings.push_back(fmt::format("odometry lost tracking: {}, each with its own world frame",
                                   counted(segments, "segment")));
  return found;
}

/// Up to kGravityFrames poses of each segment, evenly distributed.
std::vector<const CameraPose*> spread_over_segments(const std::vector<CameraPose>& poses) {
  std::vector<const CameraPose*> chosen;
  for (std::size_t first = 0, end = 0; first < poses.size(); first = end) {
    while (end < poses.size() && poses[end].segment == poses[first].segment) ++end;
    const std::size_t count = end - first, looked = std::min<std::size_t>(count, kGravityFrames);
    for (std::size_t i = 0; i < looked; ++i) chosen.push_back(&poses[first + i * count / looked]);
  }
  return chosen;
}

/// Rotates each segment upright by the gravity of a sample of its frames.
std::vector<SharedGravity> turn_upright_by_frames(const MapJob& job, Trajectory& trajectory) {
  const std::vector<const CameraPose*> looked = spread_over_segments(trajectory.poses);
  std::vector<GravitySample> samples(looked.size());
  std::vector<int> segments;
  for (const CameraPose* pose : looked) segments.push_back(pose->segment);
  planes::GravityOptions options = job.pipeline.gravity;
  options.none_where_unknown = true;
  work_through(
      static_cast<int>(looked.size()), job.threads,
      [&](int i) {
        if (job.stop.stop_requested()) return;
        samples[i].T_world_camera = looked[i]->T_world_camera;
        samples[i].gravity = planes::unknown_gravity({}, "unreadable frame");
        try {
          const Frame frame = job.recording->frame(looked[i]->frame);
          samples[i].gravity = planes::resolve_gravity(frame, options);
        } catch (const Error&) {  // reported when the frame is processed
        }
      },
      [&](int done, int all) {
        check_stop(job);
        report_progress(job, "gravity", done, all);
      });
  return turn_upright(trajectory, samples, segments);
}

void warn_of_aside(const Tracker& tracker,
                   const std::string& poses,
                   std::vector<std::string>& warnings) {
  int aside = 0, first = -1;
  for (const FrameOfTracks& frame : tracker.frames())
    if (frame.set_aside) {
      if (aside++ == 0) first = frame.frame;
    }
  if (aside > 0)
    warnings.push_back(fmt::format(
        "{} set aside, beginning with frame {}: depth and pose do not fit the map so far; "
        "check the poses in {}",
        counted(aside, "frame"), first, poses));
  const auto& frames = tracker.frames();
  std::vector<std::string> begin;  // frames
  std::size_t alone = 0, before = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    before += frames[i - 1].is_in_map();
    if (frames[i].segment == frames[i - 1].segment) continue;
    begin.push_back(std::to_string(frames[i].frame));
    alone += std::exchange(before, 0);
  }
  if (!begin.empty())
    warnings.push_back(fmt::format("the map restarts at {} {}, after {}",
                                   begin.size() == 1 ? "frame" : "frames", fmt::join(begin, ", "),
                                   counted(alone, "frame")));
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
  frame.timestamp_s = pose.timestamp_s;  // the frame's own time or, if missing, the pose's
  const SharedGravity& gravity = upright.gravity[static_cast<std::size_t>(pose.segment)];
  if (options.gravity.mode != planes::GravityMode::none)
    frame.gravity = gravity.known
                        ? gravity_at(pose.T_world_camera, gravity)
                        : planes::unknown_gravity(frame, "the gravity of its segment is unknown");
  return options_of_map(std::move(options));
}

namespace {

/// Throws Error: the first unreadable frame explains why there are no poses.
[[noreturn]] void fail_without_poses(const MapJob& job) {
  const std::string what = job.recording->info().path.string() + ": no frame has a pose";
  for (const int frame : job.frames) {
    try {
      job.recording->frame(frame);
    } catch (const Error& error) {
      throw Error(fmt::format("{}; frame {}: {}", what, frame, error.what()));
    }
  }
  throw Error(what + ": odometry found too little depth to track the camera");
}

UprightPoses upright_poses(const MapJob& job) {
  const std::string path = job.recording->info().path.string();
  if (job.recording->info().width == 0)
    throw Error(path + ": contains point clouds; expected depth images");
  UprightPoses upright;
  upright.poses = trajectory_of(job, upright.warnings);
  std::vector<CameraPose>& poses = upright.poses.poses;
  if (poses.empty()) fail_without_poses(job);
  const auto back = std::ranges::is_sorted_until(poses, {}, &CameraPose::timestamp_s);
  if (back != poses.end())
    upright.warnings.push_back(fmt::format(
        "timestamps decrease at frame {}; frames are processed in index order", back->frame));
  upright.gravity = turn_upright_by_frames(job, upright.poses);
  for (CameraPose& pose : poses) settle(pose);
  return upright;
}

}  // namespace

PlanesFrom planes_from(const planes::PipelineOptions& options, const io::RecordingInfo& recording) {
  const Intrinsics& k = recording.intrinsics;
  PlanesFrom from;
  from["camera"] = fmt::format("{}x{}, f {} {}, c {} {}, distortion {} [{}], unit {} m", k.width,
                               k.height, k.fx, k.fy, k.cx, k.cy, static_cast<int>(k.distortion),
                               fmt::join(k.coefficients, " "), recording.depth_unit_m);
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.matters(options) && info.section != "foot" && info.section != "stairs")
      from[info.name] = info.get(options);
  return from;
}

std::string difference(const PlanesFrom& found, const PlanesFrom& expected) {
  const auto shown = [](const PlanesFrom& from, const std::string& name) {
    const auto at = from.find(name);
    return at == from.end() ? "not used" : at->second.empty() ? "\"\"" : at->second;
  };
  PlanesFrom all = found;
  all.insert(expected.begin(), expected.end());
  // First the options that imply others.
  for (const char* first : {"camera", "method", "profile"})
    if (shown(found, first) != shown(expected, first))
      return fmt::format("{} is {}; expected {}", first, shown(found, first),
                         shown(expected, first));
  for (const auto& [name, value] : all)
    if (shown(found, name) != shown(expected, name))
      return fmt::format("{} is {}; expected {}", name, shown(found, name), shown(expected, name));
  return {};
}

namespace {

/// Replaces the poses by the tracker's aligned poses.
void apply_aligned_poses(const Tracker& tracker, std::vector<CameraPose>& poses) {
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
  map.planes_from = planes_from(job.pipeline, job.recording->info());
  static_cast<UprightPoses&>(map) = upright_poses(job);
  const bool helps = !job.alone && planes::finds_on_pixels(job.pipeline);
  const bool in_one_pass = job.at_own_rate || job.tracks.window_m > 0;
  Pass pass = pass_through(job, map, helps && in_one_pass ? Offer::so_far : Offer::nothing, nullptr,
                           "map", !helps || in_one_pass);
  apply_aligned_poses(pass.tracker, map.poses.poses);
  if (helps && !in_one_pass) {
    Tracker earlier = std::move(pass.tracker);
    earlier.consolidate();
    pass = pass_through(job, map, Offer::all, &earlier, "second pass", true);
  }
  map.tracker = std::move(pass.tracker);
  map.stored = std::move(pass.stored);
  map.pace = pass.pace;
  map.refused = static_cast<int>(pass.refused.size());
  std::ranges::move(pass.refused, std::back_inserter(map.warnings));
  if (pass.without_pose > 0)
    map.warnings.push_back(fmt::format("{} of {} have no pose and are skipped", pass.without_pose,
                                       counted(job.frames.size(), "frame")));
  warn_of_aside(map.tracker, map.poses.source, map.warnings);
  map.stability = stability_of(map.tracker, map.poses.poses);
  if (map.stability.kept_share < kLeastKept)
    map.warnings.push_back(
        fmt::format("only {:.0f} % of plane pixels are tracked into the next frame: frames may be "
                    "too far apart, or {} may not contain T_world_camera in meters",
                    100 * map.stability.kept_share, map.poses.source));
  return map;
}

ObservedPart observe_recording(
    const MapJob& job,
    const std::function<bool(std::size_t position)>& is_mine,
    const std::function<void(const ObservedFrame&, const UprightPoses&)>& take) {
  if (!job.trajectory && own_trajectory(job).poses.empty())
    throw Error(job.recording->info().path.string() +
                ": has no poses; specify them to process a subset of the frames, because odometry "
                "needs all frames");
  const UprightPoses upright = upright_poses(job);
  std::vector<const CameraPose*> mine;
  const std::vector<const CameraPose*> all = poses_by_frame(job, upright);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i] && is_mine(i)) mine.push_back(all[i]);
  std::vector<std::string> refused =
      observe_each(job, upright, mine, [&](const ObservedFrame& seen) { take(seen, upright); });
  ObservedPart part{static_cast<int>(refused.size()), upright.warnings};
  std::ranges::move(refused, std::back_inserter(part.warnings));
  return part;
}

}  // namespace planescope::world
