#include "core/world/map_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <iterator>
#include <thread>

#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/sha256.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/world/poses/odometry.hpp"
#include "core/world/tracks/expected.hpp"

namespace planescope::world {
namespace {

constexpr int kGravityFrames = 60;  // looked at, spread over the recording
constexpr double kLeastKept = 0.2;  // share of pixels on planes that go on in the next frame

void check_stop(const MapJob& job) {
  if (job.stop.stop_requested()) throw Cancelled();
}

void tell(const MapJob& job, const char* what, int done, int all) {
  if (job.progress) job.progress(what, done, all);
}

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

/// When frames come, in seconds after the first.
std::vector<double> arrivals_of(const MapJob& job, const std::vector<const CameraPose*>& pose_of) {
  constexpr double kRate_hz = 30;
  std::vector<double> due;
  for (std::size_t i = 0; i < pose_of.size(); ++i)
    due.push_back(pose_of[i] ? pose_of[i]->timestamp_s : job.recording->timestamp_s(job.frames[i]));
  const double first = due.front();
  for (double& time : due) time -= first;
  if (!std::ranges::is_sorted(due) || (due.size() > 1 && due.back() <= 0))
    for (std::size_t i = 0; i < due.size(); ++i) due[i] = static_cast<double>(i) / kRate_hz;
  return due;
}

/// work(i) for each frame when it comes, but for those that pass while another one is worked on.
Pace keep_pace(const MapJob& job,
               const std::vector<const CameraPose*>& pose_of,
               const std::function<void(int)>& work) {
  using Clock = std::chrono::steady_clock;
  const std::vector<double> due = arrivals_of(job, pose_of);
  const auto count = static_cast<int>(due.size());
  const Clock::time_point start = Clock::now();
  const auto now_s = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::vector<double> behind;
  for (int i = 0; i < count; ++i) {
    while (i + 1 < count && due[i + 1] <= now_s()) ++i;
    while (now_s() < due[i]) {
      check_stop(job);
      constexpr double kLongest_s = 0.05;  // until it is looked whether to stop
      std::this_thread::sleep_for(
          std::chrono::duration<double>(std::min(kLongest_s, due[i] - now_s())));
    }
    work(i);
    behind.push_back(now_s() - due[i]);
  }
  Pace pace{count, static_cast<int>(behind.size())};
  if (count > 1) pace.rate_hz = (count - 1) / std::max(1e-9, due.back());
  std::ranges::sort(behind);
  pace.behind_s_median = behind[behind.size() / 2];
  pace.behind_s_most = behind.back();
  return pace;
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

/// Of each frame of the job; null: it has none.
std::vector<const CameraPose*> poses_by_frame(const MapJob& job, const UprightPoses& upright) {
  const std::vector<CameraPose>& poses = upright.poses.poses;
  std::vector<const CameraPose*> pose_of(job.frames.size(), nullptr);
  std::size_t next = 0;
  for (std::size_t i = 0; i < pose_of.size() && next < poses.size(); ++i)
    if (poses[next].frame == job.frames[i]) pose_of[i] = &poses[next++];
  return pose_of;
}

/// A part of the map is not there, which is not what the recording is like.
struct PartError : Error {
  using Error::Error;
};

ObservedFrame observed_before(const MapJob& job, const Frame& frame, const UprightPoses& upright) {
  try {
    ObservedFrame seen = job.observed(frame.index, upright);
    if (seen.plane_of.width == frame.depth.width && seen.plane_of.height == frame.depth.height)
      return seen;
    throw Error(fmt::format("frame {} was observed at {}x{}, expected {}x{}", frame.index,
                            seen.plane_of.width, seen.plane_of.height, frame.depth.width,
                            frame.depth.height));
  } catch (const Error& error) {
    throw PartError(error.what());
  }
}

/// A frame at its pose, as the map takes it. `known`: the tracks that are offered to it.
ObservedFrame observe_frame(const MapJob& job,
                            const planes::PipelineOptions& pipeline,
                            const UprightPoses& upright,
                            const CameraPose& pose,
                            std::span<const Track* const> known = {}) {
  Frame frame = job.recording->frame(pose.frame);
  const planes::PipelineOptions options = turn_to_map(frame, pipeline, pose, upright);
  if (!job.observed || !known.empty()) {
    const std::vector<planes::KnownPlane> expected =
        expected_planes(known, frame, pose.T_world_camera, job.tracks, options.threads);
    return observe(frame,
                   planes::run_frame(frame, options, job.classifier, nullptr, nullptr, expected),
                   options, pose.T_world_camera, pose.segment);
  }
  ObservedFrame seen = observed_before(job, frame, upright);
  take_frame(seen, frame, options, pose.T_world_camera, pose.segment);
  return seen;
}

struct Threads {
  int at_once = 1;                   // frames
  planes::PipelineOptions pipeline;  // with what is left for each
};
Threads threads_of(const MapJob& job, int at_once) {
  Threads threads{std::clamp(at_once, 1, std::max(1, static_cast<int>(job.frames.size()))),
                  job.pipeline};
  threads.pipeline.threads = std::max(1, job.threads / threads.at_once);
  return threads;
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

/// The frames of a job, taken in one after the other.
struct Pass {
  Tracker tracker;
  std::map<int, StoredPlanes> stored;
  std::vector<std::string> refused;  // frames that could not be read or worked on, a line each
  int without_pose = 0;
  std::optional<Pace> pace;
};

std::vector<const Track*> sure_tracks(const Tracker& tracker, int segment) {
  std::vector<const Track*> sure;
  for (const Track& track : tracker.tracks())
    if (track.segment == segment && track.is_sure(tracker.options())) sure.push_back(&track);
  return sure;
}

/// What is offered to each frame: nothing, the tracks before it, or all of an earlier pass.
enum class Offer { nothing, so_far, all };

Pass pass_through(const MapJob& job,
                  const UprightPoses& upright,
                  Offer offer,
                  const Tracker* earlier,
                  const char* what,
                  bool is_last) {
  Pass pass{Tracker(job.tracks, earlier ? earlier->tracks().size() : 0), {}, {}, 0, {}};
  if (is_last) pass.tracker.on_left(job.on_left);
  const bool stores = is_last && offer != Offer::nothing;
  const auto count = static_cast<int>(job.frames.size());
  const Threads threads = threads_of(job, offer == Offer::so_far ? 1 : job.threads);
  const std::vector<const CameraPose*> pose_of = poses_by_frame(job, upright);
  std::vector<std::unique_ptr<ObservedFrame>> observed(count);
  std::vector<std::future<std::vector<unsigned char>>> pngs(count);
  std::vector<StoredPlanes> stored(count);
  std::vector<std::string> refused(count);
  const auto make = [&](int i) {
    if (job.stop.stop_requested()) return;
    try {
      if (!pose_of[i]) {
        if (upright.poses.estimated)
          job.recording->frame(job.frames[i]);  // if it cannot be read, that is why
        return;
      }
      std::vector<const Track*> known;
      if (offer == Offer::so_far) known = sure_tracks(pass.tracker, pass.tracker.segment());
      if (offer == Offer::all) known = sure_tracks(*earlier, earlier->frames()[i].segment);
      observed[i] = std::make_unique<ObservedFrame>(
          observe_frame(job, threads.pipeline, upright, *pose_of[i], known));
      if (!stores) return;
      for (const ObservedPlane& plane : observed[i]->planes)
        stored[i].margins.push_back(plane.margin);
      pngs[i] = std::async(std::launch::async,
                           [&image = observed[i]->plane_of] { return io::encode_png(image); });
    } catch (const PartError&) {
      throw;
    } catch (const Error& error) {
      refused[i] = fmt::format("frame {}: {}", job.frames[i], error.what());
    }
  };
  const auto take = [&](int i) {
    check_stop(job);
    if (observed[i]) {
      const FrameOfTracks& told = pass.tracker.add(*observed[i]);
      if (job.on_frame && is_last) job.on_frame(*observed[i], told);
      if (stores) {
        const std::vector<unsigned char> png = pngs[i].get();
        stored[i].sha256 = sha256_hex(std::as_bytes(std::span(png)));
        if (job.on_planes) job.on_planes(job.frames[i], png);
        pass.stored[job.frames[i]] = std::move(stored[i]);
      }
      observed[i].reset();
    } else {
      pass.tracker.skip(job.frames[i], pose_of[i] ? pose_of[i]->timestamp_s : 0);
      pass.without_pose += !pose_of[i] && refused[i].empty();
    }
    if (!refused[i].empty()) pass.refused.push_back(std::move(refused[i]));
    tell(job, what, i + 1, count);
  };
  if (job.at_own_rate)
    pass.pace = keep_pace(job, pose_of, [&](int i) { make(i), take(i); });
  else if (offer == Offer::so_far)
    for (int i = 0; i < count; ++i) make(i), take(i);
  else
    work_in_order(count, threads.at_once, make, take);
  pass.tracker.on_left({});
  return pass;
}

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
  const Threads threads = threads_of(job, job.threads);
  std::vector<const CameraPose*> mine;
  const std::vector<const CameraPose*> all = poses_by_frame(job, upright);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i] && is_mine(i)) mine.push_back(all[i]);
  std::vector<std::unique_ptr<const ObservedFrame>> observed(mine.size());
  const auto count = static_cast<int>(mine.size());
  work_in_order(
      count, threads.at_once,
      [&](int i) {
        if (job.stop.stop_requested()) return;
        try {
          observed[i] = std::make_unique<const ObservedFrame>(
              observe_frame(job, threads.pipeline, upright, *mine[i]));
        } catch (const Error&) {  // told where the parts are joined
        }
      },
      [&](int i) {
        check_stop(job);
        if (observed[i]) take(*observed[i], upright);
        observed[i].reset();
        tell(job, "frames", i + 1, count);
      });
}

}  // namespace planescope::world
