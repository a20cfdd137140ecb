// report.json, schema "planescope.report/2": docs/report.md says what each field means.

#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>

#include "core/report/compare/judgement.hpp"
#include "core/report/data/frame_json.hpp"
#include "core/report/data/report_files.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

Json depth_json(const io::RecordingInfo& info) {
  if (info.width == 0) return {};
  const Intrinsics& k = info.intrinsics;
  return {{"width", info.width},
          {"height", info.height},
          {"unit_m", info.depth_unit_m},
          {"unit_source", info.depth_unit_source},
          {"intrinsics",
           {{"fx", k.fx},
            {"fy", k.fy},
            {"cx", k.cx},
            {"cy", k.cy},
            {"distortion", to_string(k.distortion)},
            {"coefficients", k.coefficients},
            {"source", info.intrinsics_source}}}};
}

/// All but its frames.
Json to_json(const ReportRecording& recording) {
  Json json;
  json["path"] = recording.info.path.string();
  json["name"] = recording.name;
  json["format"] = recording.info.format;
  json["device"] = text_or_null(recording.info.device);
  json["sha256"] = text_or_null(recording.sha256);
  json["frame_count"] = recording.frame_count;
  json["frames_asked"] = recording.frames_asked;
  json["depth"] = depth_json(recording.info);
  json["color"] = recording.info.has_color ? Json(recording.info.color_note) : Json();
  json["warnings"] = recording.info.warnings;
  return json;
}

Json to_json(const planes::WeightsRecord& weights) {
  return {{"file", weights.file},
          {"sha256", weights.sha256},
          {"network", weights.network},
          {"training", Json::parse(weights.training)}};
}

Json record_json(const Report& report) {
  Json json;
  json["version"] = report.version;
  json["commit"] = report.commit;
  json["modified"] = report.modified;
  json["command"] = report.command;
  json["method"] = planes::to_string(report.method);
  json["classifier"] = text_or_null(report.classifier);
  json["weights"] = report.weights ? to_json(*report.weights) : Json();
  json["renderer"] = text_or_null(report.renderer);
  json["renderer_error"] = text_or_null(report.renderer_error);
  json["case_colors"] = Json::array();
  for (int c = 1; c <= 4; ++c) json["case_colors"].push_back(report.case_colors[c]);
  json["options"] = Json::array();
  for (const ReportOption& option : report.options)
    json["options"].push_back({{"name", option.name},
                               {"value", option.value},
                               {"unit", option.unit},
                               {"section", option.section},
                               {"meaning", option.meaning},
                               {"changed", option.changed}});
  return json;
}

Json totals_json(const Report& report) {
  const ReportTotals totals = totals_of(report);
  return {{"recordings", totals.recordings},
          {"frames_asked", totals.frames_asked},
          {"frames_done", totals.frames_done},
          {"frames_refused", totals.frames_refused},
          {"planes", totals.planes},
          {"points", totals.points},
          {"points_on_planes", totals.points_on_planes},
          {"metrics", totals.metrics ? metrics_json(*totals.metrics) : Json()}};
}

/// A list, or an object, that is written as it is made: a long recording's would fill the memory.
class Stream {
 public:
  Stream(std::ostream& out, int depth, char open, char close)
      : out_(out), depth_(depth), close_(close) {
    out_ << open;
  }
  ~Stream() {
    if (!empty_) new_line(depth_);
    out_ << close_;
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// What stands before the next item, or before its name.
  void next() {
    if (!empty_) out_ << ',';
    empty_ = false;
    new_line(depth_ + 1);
  }
  void item(const Json& json) {
    next();
    value(json);
  }
  void member(const std::string& name, const Json& json) {
    name_of(name);
    value(json);
  }
  void name_of(const std::string& name) {
    next();
    out_ << Json(name).dump() << ": ";
  }

 private:
  void new_line(int depth) { out_ << '\n' << std::string(static_cast<std::size_t>(depth), ' '); }
  void value(const Json& json) {
    // No string of a dump holds a line break of its own.
    for (const char c : json.dump(1, ' ', false, Json::error_handler_t::replace))
      if (c == '\n')
        new_line(depth_ + 1);
      else
        out_ << c;
  }

  std::ostream& out_;
  int depth_;
  char close_;
  bool empty_ = true;
};

void write_recordings(std::ostream& out, const Report& report) {
  Stream recordings(out, 1, '[', ']');
  for (const ReportRecording& recording : report.recordings) {
    recordings.next();
    Stream members(out, 2, '{', '}');
    const Json head = to_json(recording);
    for (const auto& [name, value] : head.items()) members.member(name, value);
    members.name_of("frames");
    Stream frames(out, 3, '[', ']');
    for (const ReportFrame& frame : recording.frames)
      frames.item(frame_json(frame, report.method == planes::Method::ours));
  }
}

void write_timings(std::ostream& out, const Report& report) {
  Stream list(out, 1, '[', ']');
  for (std::size_t r = 0; r < report.recordings.size(); ++r)
    for (const ReportFrame& frame : report.recordings[r].frames) {
      if (!frame.refused.empty()) continue;
      Json json = {{"recording", r}, {"frame", frame.index}};
      json.update(timings_json(frame));
      list.item(json);
    }
}

}  // namespace

void write_report_json(std::ostream& out, const Report& report) {
  {
    Stream json(out, 0, '{', '}');
    json.member("schema", "planescope.report/2");
    json.member("created_utc", report.created_utc);
    json.member("partial", report.partial);
    json.member("shard", text_or_null(report.shard));
    json.member("record", record_json(report));
    json.member("totals", totals_json(report));
    json.member("verdict", report.judgement ? judgement_json(*report.judgement) : Json());
    json.name_of("recordings");
    write_recordings(out, report);
    json.name_of("timings");
    write_timings(out, report);
  }
  out << '\n';
}

std::string report_json(const Report& report) {
  std::ostringstream out;
  write_report_json(out, report);
  return out.str();
}

}  // namespace planescope::report
