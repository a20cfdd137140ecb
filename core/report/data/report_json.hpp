#pragma once

// report.json, schema "planescope.report/4" (docs/report.md, assets/schemas/report.schema.json):
// written, read back, and pointed into.

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/model/json_fields.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::report {

/// Of all it says, only `created_utc` and `timings` depend on time.
void write_report_json(std::ostream& out, const Report& report);
std::string report_json(const Report& report);

/// What a later report is compared with: report.json of this version or of schema 3. Of each
/// frame there is what comparisons ask: its planes without hulls and colors, regions, metrics,
/// timings; of the report's own record the same.
/// Throws Error naming the file, the place in it, what was found and what was expected.
Report read_report(const std::filesystem::path& file);

/// A report.json of this version, but for its frames.
struct ReportHead {
  Report report;                                    // its recordings without frames
  std::vector<std::pair<std::size_t, int>> frames;  // recording, and the frame's number there
};
/// Throws as read_report() does.
ReportHead read_report_head(const std::filesystem::path& file);

/// A place in a report, as people and links write it: FILE, FILE#f12, FILE#f12/p3,
/// FILE#r2/f12/was3. FILE alone: its first frame.
struct ReportTarget {
  std::filesystem::path file;
  int recording = 1;         // of the report, from 1
  int frame = -1;            // its number in the recording; -1: the first that the report has
  int plane = 0;             // 0: none
  bool of_baseline = false;  // was: the plane is one of the baseline's
};
/// Throws Error that names the file, what was found after its name and what was expected.
ReportTarget parse_report_target(const std::string& text);

// A frame in it.

nlohmann::ordered_json metrics_json(const planes::Metrics& metrics);
/// All of it but its timings. `ours`: with what the octree's traversal tells.
nlohmann::ordered_json frame_json(const ReportFrame& frame, bool ours);
/// Of its timings and its reference work.
nlohmann::ordered_json timings_json(const ReportFrame& frame);

/// These throw Error naming the place. Hulls, and the noise elsewhere than at 1 m, are not in the
/// file.
ReportFrame read_frame(const JsonPlace& place, Extent extent);
void read_timings(const JsonPlace& place, ReportFrame& frame);

}  // namespace planescope::report
