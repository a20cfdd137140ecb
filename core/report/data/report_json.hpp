#pragma once

// Reads and writes report.json, schema "planescope.report/4" (docs/report.md,
// assets/schemas/report.schema.json), and parses references into it.

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/model/json_fields.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::report {

/// Only `created_utc` and `timings` depend on time.
void write_report_json(std::ostream& out, const Report& report);
std::string report_json(const Report& report);

/// Reads the baseline of a comparison: report.json of this version or of schema 3. Frames contain
/// only the data for comparisons: planes without hulls and colors, regions, metrics, timings;
/// likewise the report's own record. Throws Error naming the file, the place in it, what was found
/// and what was expected.
Report read_report(const std::filesystem::path& file);

/// A report.json of this version without its frames.
struct ReportHead {
  Report report;                                    // its recordings without frames
  std::vector<std::pair<std::size_t, int>> frames;  // recording, and the frame's number there
};
/// Throws like read_report().
ReportHead read_report_head(const std::filesystem::path& file);

/// A reference into a report: FILE, FILE#f12, FILE#f12/p3, FILE#r2/f12/was3. FILE alone: its first
/// frame.
struct ReportTarget {
  std::filesystem::path file;
  int recording = 1;         // in the report, from 1
  int frame = -1;            // number in the recording; -1: the first in the report
  int plane = 0;             // 0: none
  bool of_baseline = false;  // "was": the plane belongs to the baseline
};
/// Throws Error that names the file, what was found after its name and what was expected.
ReportTarget parse_report_target(const std::string& text);

// A frame in report.json.

nlohmann::ordered_json metrics_json(const planes::Metrics& metrics);
/// Without timings. `ours`: with data from the octree's traversal.
nlohmann::ordered_json frame_json(const ReportFrame& frame, bool ours);
/// Timings and reference work.
nlohmann::ordered_json timings_json(const ReportFrame& frame);

/// These throw Error naming the place. Hulls, and noise at distances other than 1 m, are not in the
/// file.
ReportFrame read_frame(const JsonPlace& place, Extent extent);
void read_timings(const JsonPlace& place, ReportFrame& frame);

}  // namespace planescope::report
