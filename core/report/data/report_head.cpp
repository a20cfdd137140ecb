#include "core/report/data/report_head.hpp"

#include <nlohmann/json.hpp>

#include "core/report/data/json_place.hpp"

namespace planescope::report {
namespace {

std::string text_or_empty(const JsonPlace& place, const char* key) {
  return place.has(key) ? place.at(key).text() : std::string();
}

Distortion distortion_of(const JsonPlace& place) {
  const std::string text = place.text();
  if (text == "none") return Distortion::none;
  if (text == "brown_conrady") return Distortion::brown_conrady;
  if (text == "inverse_brown_conrady") return Distortion::inverse_brown_conrady;
  place.fail_kind("none, brown_conrady or inverse_brown_conrady");
}

void read_depth(const JsonPlace& place, io::RecordingInfo& info) {
  info.width = place.at("width").whole(1);
  info.height = place.at("height").whole(1);
  info.depth_unit_m = place.at("unit_m").number();
  info.depth_unit_source = place.at("unit_source").text();
  const JsonPlace k = place.at("intrinsics");
  info.intrinsics.width = info.width;
  info.intrinsics.height = info.height;
  info.intrinsics.fx = k.at("fx").number();
  info.intrinsics.fy = k.at("fy").number();
  info.intrinsics.cx = k.at("cx").number();
  info.intrinsics.cy = k.at("cy").number();
  info.intrinsics.distortion = distortion_of(k.at("distortion"));
  std::size_t i = 0;
  k.at("coefficients").each([&](const JsonPlace& coefficient) {
    if (i == info.intrinsics.coefficients.size()) coefficient.fail_kind("no more coefficients");
    info.intrinsics.coefficients[i++] = coefficient.number();
  });
  info.intrinsics_source = k.at("source").text();
}

ReportRecording read_recording(const JsonPlace& place) {
  ReportRecording recording;
  recording.info.path = place.at("path").text();
  recording.name = place.at("name").text();
  // The name becomes that of a folder.
  if (recording.name.empty() || recording.name == "." || recording.name == ".." ||
      recording.name.find_first_of(std::string_view("/\0", 2)) != std::string::npos)
    place.at("name").fail_kind("a file's name");
  recording.info.format = place.at("format").text();
  recording.info.device = text_or_empty(place, "device");
  recording.sha256 = text_or_empty(place, "sha256");
  recording.frame_count = place.at("frame_count").whole(0);
  recording.frames_asked = place.at("frames_asked").whole(0);
  if (place.has("depth")) read_depth(place.at("depth"), recording.info);
  recording.info.has_color = place.has("color");
  recording.info.color_note = text_or_empty(place, "color");
  place.at("warnings").each([&](const JsonPlace& warning) {
    recording.info.warnings.push_back(warning.text());
  });
  return recording;
}

void read_record(const JsonPlace& place, Report& report) {
  report.version = place.at("version").text();
  report.commit = place.at("commit").text();
  report.modified = place.at("modified").boolean();
  report.command = place.at("command").text();
  report.method = planes::parse_method(place.at("method").text());
  report.classifier = text_or_empty(place, "classifier");
  if (place.has("weights")) {
    const JsonPlace weights = place.at("weights");
    report.weights =
        planes::WeightsRecord{weights.at("file").text(), weights.at("sha256").text(),
                              weights.at("network").text(), weights.at("training").json().dump()};
  }
  report.renderer = text_or_empty(place, "renderer");
  report.renderer_error = text_or_empty(place, "renderer_error");
  place.at("options").each([&](const JsonPlace& option) {
    report.options.push_back({option.at("name").text(), option.at("unit").text(),
                              option.at("meaning").text(), option.at("section").text(),
                              option.at("value").text(), option.at("changed").boolean()});
  });
  std::size_t c = 1;
  place.at("case_colors").each([&](const JsonPlace& color) {
    if (c < std::size(report.case_colors)) report.case_colors[c++] = color.text();
  });
}

}  // namespace

ReportHead read_report_head(const std::filesystem::path& file) {
  ReportHead head;
  const auto json = read_report_json(file, [&](std::size_t recording, const JsonPlace& frame) {
    head.frames.emplace_back(recording, frame.at("index").whole(0));
  });
  read_place(file, json, [&](const JsonPlace& place) {
    if (const JsonPlace schema = place.at("schema"); schema.text() != "planescope.report/2")
      schema.fail_kind("planescope.report/2");
    head.report.created_utc = place.at("created_utc").text();
    head.report.partial = place.at("partial").boolean();
    head.report.shard = text_or_empty(place, "shard");
    read_record(place.at("record"), head.report);
    place.at("recordings").each([&](const JsonPlace& recording) {
      head.report.recordings.push_back(read_recording(recording));
    });
    for (const auto& [recording, index] : head.frames)
      if (recording >= head.report.recordings.size()) place.at("recordings").fail_kind("objects");
  });
  return head;
}

}  // namespace planescope::report
