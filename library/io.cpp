// Recordings and maps of the public library.

#include "planescope/io.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "core/io/recording.hpp"
#include "core/world/files/map_files.hpp"
#include "library/data.hpp"

namespace planescope::v0 {
namespace {

const io::Recording& recording_of(const std::shared_ptr<const void>& data) {
  return *static_cast<const io::Recording*>(data.get());
}

void expect_frame(const io::Recording& recording, int i) {
  if (i < 0 || i >= recording.frame_count())
    throw Error(fmt::format("{}: frame {}, it has {} of them, from 0",
                            recording.info().path.string(), i, recording.frame_count()));
}

}  // namespace

Recording::Recording(const std::string& path, const RecordingOptions& options) {
  detail::guarded([&] {
    if (path.find('\0') != std::string::npos) throw Error("recording: its path has a NUL in it");
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
    for (const int i : job.frames) expect_frame(from, i);
    if (!std::ranges::is_sorted(job.frames, std::ranges::less_equal{}))
      throw Error("map: its frames do not ascend");
    if (!(options.window_m >= 0)) throw Error("map: window_m is less than 0");
    job.pipeline = by.options;
    job.classifier = by.chosen.classifier.get();
    job.tracks.window_m = options.window_m;
    job.threads = by.options.threads;
    if (!options.poses.empty()) job.trajectory = world::read_trajectory(options.poses);
    std::map<int, std::string> planes_png;
    job.on_planes = [&](int frame, std::span<const unsigned char> png) {
      planes_png[frame].assign(png.begin(), png.end());
    };
    const world::WorldMap made = world::map_recording(job);
    const std::string name = from.info().path.filename().string();
    const world::MapTexts texts = world::map_texts(made, name);
    Map map{texts.map_json, texts.tracks_json, texts.poses_tum, {}, {}, made.warnings, {}};
    for (const world::CameraPose& pose : made.poses.poses) {
      map.pose_frames.push_back(pose.frame);
      map.T_world_camera.push_back(detail::transform(pose.T_world_camera));
    }
    map.planes_png = std::move(planes_png);
    return map;
  });
}

}  // namespace planescope::v0
