#include "planescope/io.hpp"

#include <fmt/format.h>

#include "core/io/recording.hpp"
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

}  // namespace planescope::v0
