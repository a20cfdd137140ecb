#include "core/report/data/recorded_report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/data/frame_json.hpp"

namespace planescope::report {
namespace {

RecordedFrame frame_of(const JsonPlace& place) {
  RecordedFrame frame;
  frame.index = place.at("index").whole(0);
  frame.name = place.at("name").text();
  frame.sha256 = place.at("sha256").text();
  if (place.at("status").text() != "done") {
    frame.refused = place.at("message").text();
    return frame;
  }
  frame.points = place.at("counts").at("n_m").count();
  frame.points_on_planes = place.at("counts").at("points_on_planes").count();
  place.at("planes").each([&](const JsonPlace& plane) {
    frame.planes.push_back(read_plane(plane, static_cast<int>(frame.planes.size()) + 1));
  });
  if (place.has("regions"))
    frame.regions = read_regions(place.at("regions"), static_cast<int>(frame.planes.size()));
  if (place.has("metrics")) frame.metrics = read_metrics(place.at("metrics"));
  return frame;
}

bool was_typed(const std::string& source) { return source.starts_with("option --"); }

/// What the command line said of the camera.
io::RecordingOptions recording_options_of(const JsonPlace& depth) {
  io::RecordingOptions options;
  const JsonPlace k = depth.at("intrinsics");
  if (was_typed(k.at("source").text()))
    options.intrinsics = {k.at("fx").number(), k.at("fy").number(), k.at("cx").number(),
                          k.at("cy").number()};
  if (was_typed(depth.at("unit_source").text())) options.depth_unit_m = depth.at("unit_m").number();
  return options;
}
io::RecordingOptions recording_options_of(const io::RecordingInfo& info) {
  io::RecordingOptions options;
  const Intrinsics& k = info.intrinsics;
  if (was_typed(info.intrinsics_source)) options.intrinsics = {k.fx, k.fy, k.cx, k.cy};
  if (was_typed(info.depth_unit_source)) options.depth_unit_m = info.depth_unit_m;
  return options;
}

double time_ratio(const ReportFrame& frame) {
  return frame.reference_ms > 0 ? planes::paper_ms(frame.timings) / frame.reference_ms : 0;
}

void read_time_ratio(const JsonPlace& place, RecordedReport& report) {
  if (!place.has("reference_ms")) return;  // of schema 1
  const int last = static_cast<int>(report.recordings.size()) - 1;
  ReportFrame timed;
  read_timings(place, timed);
  auto& frames =
      report.recordings[static_cast<std::size_t>(place.at("recording").whole(0, last))].frames;
  const auto frame = std::ranges::find(frames, place.at("frame").whole(0), &RecordedFrame::index);
  if (frame != frames.end()) frame->time_ratio = time_ratio(timed);
}

void read_head(const JsonPlace& place, RecordedReport& report) {
  report.schema = place.at("schema").text() == "planescope.report/1" ? 1 : 2;
  report.created_utc = place.at("created_utc").text();
  report.partial = place.at("partial").boolean();
  const JsonPlace record = place.at("record");
  report.version = record.at("version").text();
  report.commit = record.at("commit").text();
  report.modified = record.at("modified").boolean();
  report.command = record.at("command").text();
  report.method = record.has("method") ? record.at("method").text() : "ours";
  if (record.has("classifier")) report.classifier = record.at("classifier").text();
  if (record.has("weights")) report.weights_sha256 = record.at("weights").at("sha256").text();
  if (place.has("verdict") && place.at("verdict").has("baseline"))
    report.baseline = place.at("verdict").at("baseline").text();
  record.at("options").each([&](const JsonPlace& option) {
    report.options.emplace_back(option.at("name").text(), option.at("value").text());
  });
  std::size_t recording = 0;
  place.at("recordings").each([&](const JsonPlace& one) {
    if (recording == report.recordings.size()) report.recordings.emplace_back();
    RecordedRecording& read = report.recordings[recording++];
    read.name = one.at("name").text();
    read.path = one.at("path").text();
    if (one.has("depth")) read.options = recording_options_of(one.at("depth"));
    one.at("frames").each([](const JsonPlace& frame) { frame.fail_kind("a frame"); });
  });
  place.at("timings").each([&](const JsonPlace& timings) { read_time_ratio(timings, report); });
}

}  // namespace

RecordedReport recorded(const Report& report) {
  RecordedReport result;
  result.version = report.version;
  result.commit = report.commit;
  result.modified = report.modified;
  result.partial = report.partial;
  result.command = report.command;
  result.created_utc = report.created_utc;
  result.method = planes::to_string(report.method);
  result.classifier = report.classifier;
  if (report.weights) result.weights_sha256 = report.weights->sha256;
  for (const ReportOption& option : report.options)
    result.options.emplace_back(option.name, option.value);
  for (const ReportRecording& recording : report.recordings) {
    RecordedRecording& now = result.recordings.emplace_back();
    now.name = recording.name;
    now.path = recording.info.path;
    now.options = recording_options_of(recording.info);
    for (const ReportFrame& frame : recording.frames) {
      RecordedFrame& one = now.frames.emplace_back();
      one.index = frame.index;
      one.name = frame.name;
      one.sha256 = frame.sha256;
      one.refused = frame.refused;
      one.points = frame.counts.kept;
      one.points_on_planes = frame.points_on_planes;
      for (const ReportPlane& plane : frame.planes) one.planes.push_back(plane.summary);
      one.regions = frame.regions;
      one.metrics = frame.metrics;
      one.time_ratio = time_ratio(frame);
    }
  }
  return result;
}

RecordedReport read_report(const std::filesystem::path& file) {
  RecordedReport report;
  const auto json = read_report_json(file, [&](std::size_t recording, const JsonPlace& frame) {
    if (recording >= report.recordings.size()) report.recordings.resize(recording + 1);
    report.recordings[recording].frames.push_back(frame_of(frame));
  });
  read_place(file, json, [&](const JsonPlace& place) { read_head(place, report); });
  return report;
}

}  // namespace planescope::report
