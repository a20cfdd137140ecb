// Writes the CSV and JUnit files of a report; reads and writes its frame records.

#include "core/report/data/report_files.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/compare/judgement.hpp"
#include "core/report/data/report_json.hpp"
#include "core/report/page/page.hpp"

namespace planescope::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kRecordSchema = "planescope.report-frame/3";
constexpr const char* kFrameFile = "frame.json";
constexpr const char* kTimingsFile = "timings.json";

// RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

/// The metrics of frame_metrics() that are columns.
constexpr const char* kCsvMetrics[] = {
    "alpha_deg", "r_p", "r_m", "point_accuracy", "mean_iou", "steppable_area_m2", "stairs_steps"};

std::string csv_number(double value) {
  return std::isnan(value) ? std::string() : fmt::format("{:.6g}", value);
}

/// Missing values are empty.
std::string csv_line(const ReportRecording& recording, const ReportFrame& frame) {
  const std::string start = fmt::format(
      "{},{},{},{},{}", quoted(recording.info.path.string()), frame.index, quoted(frame.name),
      frame.refused.empty() ? "done" : "refused", quoted(frame.refused));
  if (!frame.refused.empty()) return start + std::string(26, ',') + "\n";
  const planes::CloudCounts& c = frame.counts;
  const Vec3d& g = frame.gravity.direction;
  // Without gravity there is no direction, and no plane is h or v.
  std::string gravity = ",,", classes = ",";
  if (frame.gravity.known()) {
    gravity = fmt::format("{:.6f},{:.6f},{:.6f}", g.x(), g.y(), g.z());
    classes = fmt::format("{},{}", frame.planes_h, frame.planes_v);
  }
  std::string metrics = frame.metrics ? std::to_string(frame.metrics->planes_truth) : "";
  for (const char* name : kCsvMetrics)
    metrics += "," + csv_number(find_frame_metric(name).value(frame));
  // The flight with the most steps.
  const bool has_flight = frame.terrain && !frame.terrain->flights.empty();
  const FlightFigures flight = has_flight ? frame.terrain->flights.front() : FlightFigures();
  return start + fmt::format(",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                             to_string(frame.gravity.source), gravity, c.pixels, c.no_measurement,
                             c.invalid, c.beyond_range, c.outside_cube, c.kept, frame.voxels,
                             classes, frame.points_on_planes, frame.segment.unassigned, metrics,
                             has_flight ? csv_number(flight.rise_m) : "",
                             has_flight ? csv_number(flight.going_m) : "", frame.planes_undecided);
}

// junit.xml, valid against the schema of Ant's JUnit task and readable by Jenkins and GitLab.

/// XML 1.0 does not allow most control characters, not even escaped.
std::string xml_text(const std::string& text) {
  std::string lines;
  for (const char c : text) lines += c == '\n' ? std::string(" | ") : std::string(1, c);
  return html::escaped(html::valid_text(lines));
}

struct JunitSuite {
  std::string name, cases, notes;
  int tests = 0, failures = 0, errors = 0, skipped = 0;
  double seconds = 0;

  void add(const std::string& test, double time, const std::string& outcome) {
    ++tests;
    seconds += time;
    cases += fmt::format("  <testcase name=\"{}\" classname=\"{}\" time=\"{:.6f}\"", xml_text(test),
                         xml_text(name), time);
    cases += outcome.empty() ? "/>\n" : ">\n" + outcome + "  </testcase>\n";
  }
  std::string xml(int id, const std::string& created_utc) const {
    // ISO 8601 without a zone, as the schema requires. The report does not contain a host name.
    return fmt::format(
        " <testsuite id=\"{}\" name=\"{}\" package=\"planescope\" hostname=\"localhost\" "
        "timestamp=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" "
        "time=\"{:.6f}\">\n"
        "  <properties/>\n{}  <system-out{}\n  <system-err/>\n </testsuite>\n",
        id, xml_text(name), created_utc.substr(0, 19), tests, failures, errors, skipped, seconds,
        cases, notes.empty() ? "/>" : ">" + notes + "</system-out>");
  }
};

/// `anchor`: of the frame on the page.
std::string failure(const std::vector<const Breach*>& breaches,
                    const ReportFrame* frame,
                    const std::string& anchor) {
  std::string text;
  for (const Breach* breach : breaches) text += xml_text(breach->text()) + "\n";
  if (frame)
    for (const ReportPicture& picture : frame->pictures) text += xml_text(picture.file) + "\n";
  text += "index.html\n";
  if (frame) text += fmt::format("planescope view --open report.json#{}\n", anchor);
  return fmt::format("   <failure message=\"{}\" type=\"{}\">{}</failure>\n",
                     xml_text(breaches[0]->text()), xml_text(breaches[0]->rule.metric), text);
}

/// Changes of undecided planes, for readers of a passing suite. `recording` empty: of all.
std::string notes_of(const Report& report, const std::string& recording) {
  std::string text;
  if (!report.judgement) return text;
  for (const Breach& note : report.judgement->notes)
    if (note.recording == recording)
      text +=
          fmt::format("note: {}{}\n", note.frame < 0 ? "" : fmt::format("frame {}: ", note.frame),
                      xml_text(note.text()));
  return text;
}

/// Errors of one frame, or with frame -1 of the whole recording. Keys: recording, whether the frame
/// is missing, frame number.
using Broken = std::map<std::tuple<std::string, bool, int>, std::vector<const Breach*>>;

Broken broken_by_frame(const Report& report) {
  Broken broken;
  if (report.judgement)
    for (const Breach& breach : report.judgement->breaches)
      if (breach.rule.level == RuleLevel::error)
        broken[{breach.recording, breach.is_missing, breach.frame}].push_back(&breach);
  return broken;
}

void add_frame(JunitSuite& suite,
               const ReportFrame& frame,
               const std::string& anchor,
               Broken& broken) {
  const auto found = broken.find({suite.name, false, frame.index});
  std::string outcome;
  if (frame.unreadable) {
    ++suite.errors;
    outcome = fmt::format("   <error message=\"{}\" type=\"damaged\"/>\n", xml_text(frame.refused));
  } else if (found != broken.end()) {
    ++suite.failures;
    outcome = failure(found->second, &frame, anchor);
  } else if (!frame.refused.empty()) {
    ++suite.skipped;
    outcome = fmt::format("   <skipped message=\"{}\"/>\n", xml_text(frame.refused));
  }
  suite.add(fmt::format("frame {}", frame.index), planes::total_ms(frame.timings) / 1000, outcome);
  if (found != broken.end()) broken.erase(found);
}

/// Errors of no single frame in this report: rules over many frames, and missing frames.
void add_rest(JunitSuite& suite, Broken& broken, bool of_any) {
  for (auto at = broken.begin(); at != broken.end();) {
    const auto& [recording, is_missing, frame] = at->first;
    if (recording != suite.name && !of_any) {
      ++at;
      continue;
    }
    ++suite.failures;
    suite.add(
        frame < 0 ? "all frames" : fmt::format("{}frame {}", is_missing ? "baseline " : "", frame),
        0, failure(at->second, nullptr, {}));
    at = broken.erase(at);
  }
}

ReportFrame read_record(const fs::path& dir, const Json& json) {
  ReportFrame frame = read_place(dir / kFrameFile, json, [](const JsonPlace& place) {
    return read_frame(place.at("frame"), Extent::whole);
  });
  read_place(dir / kFrameFile, json, [&](const JsonPlace& place) {
    std::size_t k = 0;
    place.at("color_ids").each([&](const JsonPlace& id) {
      if (k < frame.planes.size()) frame.planes[k++].color_id = id.whole(0);
    });
  });
  const Json timings = read_json<Json>(dir / kTimingsFile);
  read_place(dir / kTimingsFile, timings,
             [&](const JsonPlace& place) { read_timings(place, frame); });
  return frame;
}

}  // namespace

std::string frames_csv(const Report& report) {
  std::string text =
      "recording,frame,name,status,message,gravity_source,gravity_x,gravity_y,gravity_z,pixels,"
      "no_measurement,invalid,beyond_range,outside_cube,n_m,n_d,planes_h,planes_v,"
      "points_on_planes,voxels_in_no_plane,truth_planes";
  for (const char* name : kCsvMetrics) text += fmt::format(",{}", name);
  text += ",rise_m,going_m,planes_undecided\n";
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames) text += csv_line(recording, frame);
  return text;
}

std::string junit_xml(const Report& report) {
  Broken broken = broken_by_frame(report);
  std::string suites;
  int id = 0;
  const auto take = [&](const JunitSuite& suite) { suites += suite.xml(id++, report.created_utc); };
  for (std::size_t r = 0; r < report.recordings.size(); ++r) {
    const ReportRecording& recording = report.recordings[r];
    JunitSuite suite;
    suite.name = recording.name;
    suite.notes = notes_of(report, recording.name);
    for (const ReportFrame& frame : recording.frames)
      add_frame(suite, frame, html::frame_anchor(report.recordings.size(), r, frame.index), broken);
    add_rest(suite, broken, false);
    take(suite);
  }
  const std::string notes = notes_of(report, "");
  if (!broken.empty() || !notes.empty()) {
    JunitSuite suite;
    suite.name = "all recordings";
    suite.notes = notes;
    add_rest(suite, broken, true);
    take(suite);
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" + suites + "</testsuites>\n";
}

void write_frame_record(const fs::path& dir,
                        const ReportFrame& frame,
                        bool ours,
                        const std::string& key) {
  write_file_text(dir / kTimingsFile, json_text(timings_json(frame)));
  Json color_ids = Json::array();
  for (const ReportPlane& plane : frame.planes) color_ids.push_back(plane.color_id);
  write_file_text(dir / kFrameFile, json_text({{"schema", kRecordSchema},
                                               {"key", key},
                                               {"color_ids", color_ids},
                                               {"frame", frame_json(frame, ours)}}));
}

std::optional<ReportFrame> find_frame_record(const fs::path& dir, const std::string& key) {
  if (!fs::exists(dir / kFrameFile)) return std::nullopt;
  const Json json = read_json<Json>(dir / kFrameFile);
  const bool is_it = read_place(dir / kFrameFile, json, [&](const JsonPlace& place) {
    return place.at("schema").text() == kRecordSchema && place.at("key").text() == key;
  });
  if (!is_it || key.empty()) return std::nullopt;
  return read_record(dir, json);
}

ReportFrame read_frame_record(const fs::path& dir) {
  const Json json = read_json<Json>(dir / kFrameFile);
  read_place(dir / kFrameFile, json, [](const JsonPlace& place) { place.schema({kRecordSchema}); });
  return read_record(dir, json);
}

void write_report_files(const std::filesystem::path& dir, const Report& report) {
  // Replace links in the folder instead of following them.
  for (const char* name : {"frames.csv", "junit.xml", "index.html", "report.json"})
    if (fs::is_symlink(dir / name)) fs::remove(dir / name);
  write_file_text(dir / "frames.csv", frames_csv(report));
  write_file_text(dir / "junit.xml", junit_xml(report));
  write_overviews(dir, report);
  write_file_stream(dir / "index.html",
                    [&](std::ostream& out) { write_report_page(out, report, dir); });
  write_file_stream(dir / "report.json",
                    [&](std::ostream& out) { write_report_json(out, report); });
}

}  // namespace planescope::report
