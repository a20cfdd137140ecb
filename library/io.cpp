// Recordings and maps of the public library.

#include "planescope/io.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <numbers>

#include "core/io/recording.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/world/files/map_files.hpp"
#include "library/data.hpp"

namespace planescope::v0 {
namespace {

const io::Recording& recording_of(const std::shared_ptr<const void>& data) {
  return *static_cast<const io::Recording*>(data.get());
}

void expect_frame(const io::Recording& recording, int i) {
  if (i < 0 || i >= recording.frame_count())
    throw Error(
        fmt::format("{}: frame {} is out of range; the recording has {} frames, numbered from 0",
                    recording.info().path.string(), i, recording.frame_count()));
}

world::CameraPose camera_pose(int frame, double timestamp_s, const Transform& T_world_camera) {
  const std::string what = fmt::format("pose of frame {}", frame);
  return {.frame = frame,
          .timestamp_s = timestamp_s,
          .T_world_camera = detail::pose(T_world_camera, what.c_str())};
}

void expect_near(const world::Trajectory& trajectory) {
  const world::CameraPose& last = trajectory.poses.back();
  const std::string far =
      world::too_far(last.T_world_camera, trajectory.poses.front().T_world_camera);
  if (!far.empty()) throw Error(fmt::format("pose of frame {}: {}", last.frame, far));
}

world::Trajectory trajectory_of(const std::map<int, Transform>& T_world_camera,
                                const io::Recording& recording) {
  world::Trajectory trajectory{"the caller", {}};
  for (const auto& [frame, T] : T_world_camera) {
    expect_frame(recording, frame);
    trajectory.poses.push_back(camera_pose(frame, recording.timestamp_s(frame), T));
    expect_near(trajectory);
  }
  return trajectory;
}

/// If z did not point up, walls would become floors.
void expect_upright(const ::planescope::Frame& frame,
                    const world::CameraPose& pose,
                    const planes::PipelineOptions& options) {
  if (options.gravity.mode == planes::GravityMode::none) return;
  const Vec3d down = pose.T_world_camera.linear().transpose() * Vec3d(0, 0, -1);
  std::string doubt = planes::doubt_in_gravity(frame, down, options.gravity);
  if (frame.gravity && frame.gravity->known()) {
    constexpr double kMostDeg = 20;
    const double off = std::acos(std::clamp(down.dot(frame.gravity->direction), -1.0, 1.0)) * 180 /
                       std::numbers::pi;
    doubt = off > kMostDeg ? fmt::format("the frame's gravity is {:.0f} deg off", off) : "";
  }
  if (!doubt.empty())
    throw Error(fmt::format("pose of frame 0: {}; expected a world frame with z up", doubt));
}

Map map_of(const world::WorldMap& made, const std::string& name) {
  const world::MapTexts texts = world::map_texts(made, name);
  Map map{texts.map_json, texts.tracks_json, texts.poses_tum, {}, {}, made.warnings, {}};
  for (const world::CameraPose& pose : made.poses.poses) {
    map.pose_frames.push_back(pose.frame);
    map.T_world_camera.push_back(detail::transform(pose.T_world_camera));
  }
  return map;
}

}  // namespace

Recording::Recording(const std::string& path, const RecordingOptions& options) {
  detail::guarded([&] {
    if (path.find('\0') != std::string::npos)
      throw Error("recording: the path contains a NUL character");
    io::RecordingOptions core;
    core.intrinsics = options.intrinsics;
    core.depth_unit_m = options.depth_unit_m;
    core.color = options.color;
    data_ = std::shared_ptr<const io::Recording>(io::open_recording(path, core));
  });
}

RecordingInfo Recording::info() const {
  const io::RecordingInfo& from = recording_of(data_).info();
  RecordingInfo info;
  info.path = from.path.string();
  info.format = from.format;
  info.device = from.device;
  if (from.width > 0) info.camera = detail::camera(from.intrinsics);
  info.depth_unit_m = from.depth_unit_m;
  info.has_color = from.has_color;
  info.warnings = from.warnings;
  info.damaged = from.damaged;
  return info;
}

int Recording::size() const { return recording_of(data_).frame_count(); }

Frame Recording::operator[](int i) const {
  return detail::guarded([&] {
    expect_frame(recording_of(data_), i);
    return detail::Access::frame(recording_of(data_).frame(i));
  });
}

double Recording::timestamp_s(int i) const {
  return detail::guarded([&] {
    expect_frame(recording_of(data_), i);
    return recording_of(data_).timestamp_s(i);
  });
}

Map make_map(const Recording& recording, const Segmenter& segmenter, const MapOptions& options) {
  return detail::guarded([&] {
    const io::Recording& from = recording_of(recording.data_);
    const detail::SegmenterData& by = detail::Access::segmenter(segmenter);
    world::MapJob job;
    job.recording = &from;
    job.frames = options.frames;
    for (int i = 0; options.frames.empty() && i < from.frame_count(); ++i) job.frames.push_back(i);
    for (const int i : job.frames) {
      expect_frame(from, i);
      if (const auto at = from.info().damaged.find(i);
          at != from.info().damaged.end() && !options.skip_damaged)
        throw Error(fmt::format("frame {}: {}", i, at->second));
    }
    if (!std::ranges::is_sorted(job.frames, std::ranges::less_equal{}))
      throw Error("map: the frame numbers are not in ascending order");
    if (!(options.window_m >= 0)) throw Error("map: window_m is less than 0");
    job.pipeline = by.options;
    job.classifier = by.chosen.classifier.get();
    job.tracks.window_m = options.window_m;
    job.threads = by.options.threads;
    if (!options.poses.empty() && !options.T_world_camera.empty())
      throw Error("map: poses are set both as a file and as transforms; expected one or the other");
    if (!options.poses.empty()) job.trajectory = world::read_trajectory(options.poses);
    if (!options.T_world_camera.empty())
      job.trajectory = trajectory_of(options.T_world_camera, from);
    std::map<int, std::string> planes_png;
    job.on_planes = [&](int frame, std::span<const unsigned char> png) {
      planes_png[frame].assign(png.begin(), png.end());
    };
    const world::WorldMap made = world::map_recording(job);
    if (made.refused > 0 && !options.skip_damaged)
      throw Error(*std::ranges::find_if(
          made.warnings, [](const std::string& line) { return line.starts_with("frame "); }));
    const std::string name = from.info().path.filename().string();
    Map map = map_of(made, name);
    map.planes_png = std::move(planes_png);
    return map;
  });
}

// ---- Frames as they arrive ----

struct Mapper::State {
  State(const Segmenter& by, double window_m) : segmenter(by) {
    map.tracker = world::Tracker(world::TrackOptions{.window_m = window_m});
    map.poses.source = "the caller";
  }
  int size() const { return static_cast<int>(map.poses.poses.size()); }

  mutable std::mutex mutex;
  Segmenter segmenter;
  world::WorldMap map;
};

Mapper::Mapper(const Segmenter& segmenter, double window_m) {
  detail::guarded([&] {
    if (!(window_m >= 0)) throw Error("map: window_m is less than 0");
    state_ = std::make_shared<State>(segmenter, window_m);
  });
}

int Mapper::size() const {
  const std::lock_guard lock(state_->mutex);
  return state_->size();
}

MappedFrame Mapper::add(const Frame& given, const Transform& T_world_camera) {
  return detail::guarded([&] {
    const std::lock_guard lock(state_->mutex);
    world::WorldMap& map = state_->map;
    const detail::SegmenterData& by = detail::Access::segmenter(state_->segmenter);
    ::planescope::Frame frame = detail::Access::frame(given);
    if (frame.is_cloud()) throw Error("frame: point cloud; expected a depth image");
    const int number = state_->size();
    world::CameraPose pose = camera_pose(number, frame.timestamp_s, T_world_camera);
    world::settle(pose);
    if (number == 0) {
      expect_upright(frame, pose, by.options);
      map.gravity = {{.known = true, .samples = 1, .source = GravitySource::option}};
      io::RecordingInfo info;
      info.intrinsics = frame.intrinsics;
      info.depth_unit_m = frame.depth_unit_m;
      map.planes_from = world::planes_from(by.options, info);
    }
    world::Trajectory near{map.poses.source, {number == 0 ? pose : map.poses.poses[0], pose}};
    expect_near(near);
    frame.index = number;
    const planes::PipelineOptions options = world::turn_to_map(frame, by.options, pose, map);
    std::vector<const world::Track*> known;
    if (planes::finds_on_pixels(options))
      known = world::sure_tracks(map.tracker, map.tracker.segment_of(pose.segment));
    const std::vector<planes::KnownPlane> expected = world::expected_planes(
        known, frame, pose.T_world_camera, map.tracker.options(), options.threads);
    planes::FrameResult found =
        planes::run_frame(frame, options, by.chosen.classifier.get(), nullptr, nullptr, expected);
    world::ObservedFrame seen =
        world::observe(frame, found, options, pose.T_world_camera, pose.segment);
    const world::FrameOfTracks& matched = map.tracker.add(seen);
    std::vector<int> tracks;
    for (int i = 0; i < matched.listed; ++i)
      tracks.push_back(world::final_track(map.tracker.tracks(), matched.track_of[i]));
    pose.T_world_camera = matched.T_world_camera;
    pose.quaternion = {};
    world::settle(pose);
    map.poses.poses.push_back(pose);
    return MappedFrame{
        detail::make_result(detail::Access::frame(std::move(frame)), options, std::move(found)),
        std::move(tracks), detail::transform(pose.T_world_camera), matched.set_aside};
  });
}

Map Mapper::map() const {
  return detail::guarded([&] {
    const std::lock_guard lock(state_->mutex);
    if (state_->size() == 0) throw Error("map: no frames; expected at least one from add()");
    world::WorldMap map = state_->map;
    map.stability = world::stability_of(map.tracker, map.poses.poses);
    return map_of(map, "Mapper");
  });
}

}  // namespace planescope::v0
