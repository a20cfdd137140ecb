#pragma once

// A report as a later one is compared with it: what report.json holds of its frames' planes.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/report/data/report_data.hpp"

namespace planescope::report {

struct RecordedFrame {
  int index = 0;
  std::string name;
  std::string sha256;   // Recording::frame_hash
  std::string refused;  // why there are no planes; empty: it was processed
  std::uint64_t points = 0, points_on_planes = 0;
  std::vector<PlaneSummary> planes;        // by id - 1; hulls are not recorded
  RegionSample regions;                    // empty in reports before schema 2
  std::optional<planes::Metrics> metrics;  // without pq before schema 2: NaN
  // Time taken against that of work that was timed in the same run; 0: not measured.
  double time_ratio = 0;
};

struct RecordedRecording {
  std::string name;
  std::vector<RecordedFrame> frames;
  std::filesystem::path path = {};    // as it was typed
  io::RecordingOptions options = {};  // --intrinsics, --depth-unit
};

struct RecordedReport {
  int schema = 2;  // planescope.report/N
  std::string version, commit, command, created_utc;
  bool modified = false, partial = false;
  std::string method;                                        // as --method has it
  std::string classifier;                                    // empty: none
  std::string weights_sha256;                                // empty: no network
  std::filesystem::path baseline;                            // as it was typed; empty: none
  std::vector<std::pair<std::string, std::string>> options;  // name and value
  std::vector<RecordedRecording> recordings;
};

RecordedReport recorded(const Report& report);

/// Reads report.json of this or of an earlier version. Throws Error naming the file, the place in
/// it, what was found and what was expected.
RecordedReport read_report(const std::filesystem::path& file);

}  // namespace planescope::report
