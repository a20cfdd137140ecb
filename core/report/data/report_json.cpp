// Writes and reads report.json; docs/report.md describes each field.

#include "core/report/data/report_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <regex>
#include <sstream>

#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"
#include "core/report/compare/judgement.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kReportSchema = "planescope.report/4";

/// Reads a report.json without its frames, which may not fit into memory: each is passed to
/// `on_frame` with its recording's index as it is parsed, and then dropped.
Json read_report_json(
    const std::filesystem::path& file,
    const std::function<void(std::size_t recording, const JsonPlace& frame)>& on_frame) {
  // Depths: the report 0, a recording 2, a frame 4.
  std::string member, member_of_recording, first_error;
  std::size_t recordings = 0, frames = 0;
  int times_there = 0;
  const auto take = [&](int depth, Json::parse_event_t event, Json& parsed) {
    check_depth(depth, file.string());
    if (event == Json::parse_event_t::key && depth == 1) {
      member = parsed.get<std::string>();
      times_there += member == "recordings";
      member_of_recording.clear();
    }
    if (member != "recordings") return true;
    if (event == Json::parse_event_t::key && depth == 3)
      member_of_recording = parsed.get<std::string>();
    if (event == Json::parse_event_t::object_start && depth == 2) {
      ++recordings;
      frames = 0;
      member_of_recording.clear();
    }
    if (event != Json::parse_event_t::object_end || depth != 4 || recordings == 0 ||
        member_of_recording != "frames")
      return true;
    try {
      on_frame(recordings - 1,
               JsonPlace(parsed, fmt::format("recordings[{}].frames[{}]", recordings - 1, frames)));
    } catch (const Error& error) {
      if (first_error.empty()) first_error = error.what();
    }
    ++frames;
    return false;
  };
  std::ifstream stream = open_to_read(file);
  Json json = Json::parse(stream, take, false);
  if (json.is_discarded())
    throw Error(file.string() + ": not valid JSON; expected the report.json of a report");
  read_place(file, json, [](const JsonPlace& place) {
    place.schema({"planescope.report/3", kReportSchema});
  });
  if (times_there > 1) throw Error(file.string() + ": \"recordings\" appears twice");
  if (!first_error.empty()) throw Error(file.string() + ": " + first_error);
  return json;
}

/// kCompared: fields that show the camera options on the command line (options_of()).
void depth_fields(auto& fields, auto& info) {
  fields.whole("width", info.width, kPlain, 1);
  fields.whole("height", info.height, kPlain, 1);
  fields("unit_m", info.depth_unit_m, kCompared);
  fields("unit_source", info.depth_unit_source, kCompared);
  fields.object("intrinsics", kCompared, [&](auto& of) {
    auto& k = info.intrinsics;
    of("fx", k.fx, kCompared);
    of("fy", k.fy, kCompared);
    of("cx", k.cx, kCompared);
    of("cy", k.cy, kCompared);
    of("distortion", k.distortion);
    of("coefficients", k.coefficients);
    of("source", info.intrinsics_source, kCompared);
  });
}

/// All fields except its frames.
template <typename Fields>
void recording_fields(Fields& fields, auto& recording) {
  auto& info = recording.info;
  fields("path", info.path, kCompared);
  fields("name", recording.name, kCompared);
  fields("format", info.format);
  fields("device", info.device, kOrNull);
  fields.with_default("topic", info.topic, "", kCompared);
  fields("sha256", recording.sha256, kOrNull);
  fields("frame_count", recording.frame_count, kCompared);
  fields("frames_asked", recording.frames_asked);
  fields.maybe_object("depth", info.width > 0, kCompared,
                      [&](auto& depth) { depth_fields(depth, info); });
  if constexpr (Fields::kReads) {
    info.has_color = fields.place().has("color");
    fields("color", info.color_note, kOrNull);
    info.intrinsics.width = info.width;
    info.intrinsics.height = info.height;
  } else {
    fields.json()["color"] = info.has_color ? Json(info.color_note) : Json();
  }
  fields("warnings", info.warnings);
}

template <typename Fields>
void weights_fields(Fields& fields, auto& weights) {
  fields("file", weights.file);
  fields("sha256", weights.sha256, kCompared);
  fields("network", weights.network);
  if constexpr (!Fields::kReads)
    fields.json()["training"] =
        parse_json<Json>(weights.training, weights.file + ": training record");
  else if (fields.is_read("training", kPlain))
    weights.training = fields.place().at("training").json().dump();
}

/// "#rrggbb" of the cases from I on.
template <typename Fields>
void case_colors_field(Fields& fields, auto& colors) {
  if constexpr (!Fields::kReads) {
    fields.json()["case_colors"] = Json(std::vector<std::string>(colors + 1, std::end(colors)));
  } else if (fields.is_read("case_colors", kPlain)) {
    std::size_t c = 1;
    fields.place().at("case_colors").each([&](const JsonPlace& color) {
      if (c < std::size(colors)) colors[c++] = color.text();
    });
  }
}

template <typename Fields>
void record_fields(Fields& fields, auto& report) {
  fields("version", report.version, kCompared);
  fields("commit", report.commit, kCompared);
  fields("modified", report.modified, kCompared);
  fields("command", report.command, kCompared);
  fields("method", report.method, kCompared | kOptional);
  fields("classifier", report.classifier, kCompared | kOrNull);
  fields.maybe_object("weights", report.weights.has_value(), kCompared, [&](auto& of) {
    if constexpr (Fields::kReads) report.weights.emplace();
    weights_fields(of, *report.weights);
  });
  fields("renderer", report.renderer, kOrNull);
  fields("renderer_error", report.renderer_error, kOrNull);
  case_colors_field(fields, report.case_colors);
  fields.list("options", report.options, kCompared, [](auto& of, auto& option) {
    of("name", option.name, kCompared);
    of("value", option.value, kCompared);
    of("unit", option.unit);
    of("section", option.section);
    of("meaning", option.meaning);
    of("changed", option.changed);
  });
}

/// The report's fields except its recordings and the totals computed from them.
void head_fields(auto& fields, auto& report) {
  fields("created_utc", report.created_utc, kCompared);
  fields("partial", report.partial, kCompared);
  fields("shard", report.shard, kOrNull);
  fields.object("record", kCompared, [&](auto& of) { record_fields(of, report); });
}

Json totals_json(const Report& report) {
  const ReportTotals totals = totals_of(report);
  return {{"recordings", totals.recordings},
          {"frames_asked", totals.frames_asked},
          {"frames_done", totals.frames_done},
          {"frames_refused", totals.frames_refused},
          {"planes", totals.planes},
          {"planes_undecided", totals.planes_undecided},
          {"points", totals.points},
          {"points_on_planes", totals.points_on_planes},
          {"metrics", totals.metrics ? metrics_json(*totals.metrics) : Json()}};
}

/// Writes a list or object incrementally, since a long recording's would fill the memory.
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

  /// Writes the separator before the next item or its name.
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
    // A line break in a dump is never part of a string.
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
    Json head;
    FieldWriter fields(head);
    recording_fields(fields, recording);
    for (const auto& [name, value] : head.items()) members.member(name, value);
    members.name_of("frames");
    Stream frames(out, 3, '[', ']');
    for (const ReportFrame& frame : recording.frames)
      frames.item(frame_json(frame, report.is_ours()));
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

/// The rest of the file after its frames; the recordings may exist already.
void read_head(const JsonPlace& place, Extent extent, Report& report) {
  FieldReader fields(place, extent);
  head_fields(fields, report);
  std::size_t r = 0;
  place.at("recordings").each([&](const JsonPlace& one) {
    if (r == report.recordings.size()) report.recordings.emplace_back();
    FieldReader of(one, extent);
    recording_fields(of, report.recordings[r++]);
  });
}

void read_reference_time(const JsonPlace& place, Report& report) {
  const int last = static_cast<int>(report.recordings.size()) - 1;
  ReportFrame timed;
  read_timings(place, timed);
  auto& frames =
      report.recordings[static_cast<std::size_t>(place.at("recording").whole(0, last))].frames;
  const auto frame = std::ranges::find(frames, place.at("frame").whole(0), &ReportFrame::index);
  if (frame == frames.end()) return;
  frame->timings = timed.timings;
  frame->reference_ms = timed.reference_ms;
}

/// The name becomes a folder name.
void expect_file_name(const JsonPlace& place) {
  const std::string name = place.text();
  if (name.empty() || name == "." || name == ".." ||
      name.find_first_of(std::string_view("/\0", 2)) != std::string::npos)
    place.fail_kind("a file name");
}

}  // namespace

void write_report_json(std::ostream& out, const Report& report) {
  {
    Json head = {{"schema", kReportSchema}};
    FieldWriter fields(head);
    head_fields(fields, report);
    head["totals"] = totals_json(report);
    head["verdict"] = report.judgement ? judgement_json(*report.judgement) : Json();
    Stream members(out, 0, '{', '}');
    for (const auto& [name, value] : head.items()) members.member(name, value);
    members.name_of("recordings");
    write_recordings(out, report);
    members.name_of("timings");
    write_timings(out, report);
  }
  out << '\n';
}

std::string report_json(const Report& report) {
  std::ostringstream out;
  out.exceptions(std::ios::badbit);  // otherwise it would silently truncate when out of memory
  write_report_json(out, report);
  return out.str();
}

Report read_report(const std::filesystem::path& file) {
  Report report;
  const auto json = read_report_json(file, [&](std::size_t recording, const JsonPlace& frame) {
    if (recording >= report.recordings.size()) report.recordings.resize(recording + 1);
    report.recordings[recording].frames.push_back(read_frame(frame, Extent::compared));
  });
  read_place(file, json, [&](const JsonPlace& place) {
    read_head(place, Extent::compared, report);
    if (place.has("verdict") && place.at("verdict").has("baseline"))
      report.baseline = place.at("verdict").at("baseline").text();
    place.at("recordings").each([](const JsonPlace& recording) {
      recording.at("frames").each([](const JsonPlace& frame) { frame.fail_kind("a frame"); });
    });
    place.at("timings").each([&](const JsonPlace& one) { read_reference_time(one, report); });
  });
  return report;
}

ReportHead read_report_head(const std::filesystem::path& file) {
  ReportHead head;
  const auto json = read_report_json(file, [&](std::size_t recording, const JsonPlace& frame) {
    head.frames.emplace_back(recording, frame.at("index").whole(0));
  });
  read_place(file, json, [&](const JsonPlace& place) {
    place.schema({kReportSchema});
    read_head(place, Extent::whole, head.report);
    planes::parse_method(head.report.method);  // throws for methods that this build does not have
    place.at("recordings").each([](const JsonPlace& recording) {
      expect_file_name(recording.at("name"));
    });
    for (const auto& [recording, index] : head.frames)
      if (recording >= head.report.recordings.size()) place.at("recordings").fail_kind("objects");
  });
  return head;
}

ReportTarget parse_report_target(const std::string& text) {
  const std::size_t at = text.rfind('#');
  ReportTarget target;
  target.file = text.substr(0, at);
  if (at == std::string::npos) return target;
  const std::string place = text.substr(at + 1);
  static const std::regex pattern(R"((?:r(\d{1,9})/)?f(\d{1,9})(?:/(p|was)(\d{1,9}))?)");
  std::smatch parts;
  const bool matches = std::regex_match(place, parts, pattern);
  if (matches && parts[1].matched) target.recording = std::stoi(parts[1]);
  if (matches && parts[4].matched) target.plane = std::stoi(parts[4]);
  if (!matches || target.recording < 1 || (parts[4].matched && target.plane < 1))
    throw Error(fmt::format(
        "{}: '{}' is not a location in a report; expected f<frame>, f<frame>/p<plane>, or "
        "f<frame>/was<baseline plane>, preceded by r<n>/ if the report has several recordings",
        target.file.string(), place));
  target.frame = std::stoi(parts[2]);
  target.of_baseline = parts[3] == "was";
  return target;
}

}  // namespace planescope::report
