#pragma once

// From a report's line to the window: the recording, the options of both runs, the plane, and where
// in a run the window begins.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"
#include "core/debug/replay/run.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/compare/compare_reports.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::desktop {

/// Whether `where`, without what follows '#', is a report. False for what cannot be read.
bool is_report(const std::string& where);

struct ReportLink {
  std::string target;                              // report_target.hpp
  std::filesystem::path baseline;                  // empty: the one that the report names
  std::optional<std::filesystem::path> label_dir;  // nothing: beside the recording
  bool only_given = false;                         // the recording is one of those that are open
};

/// Options of the report become those of run B, of its baseline those of run A. The recording is
/// looked for among those open, as it was typed, beside the report, and from its folder and those
/// above on: the first whose frame has the same SHA-256. A damaged frame does not keep the
/// others from being shown. Throws Error that names the file and what is wrong, the state
/// unchanged: a place that the report does not have, a recording or weights that are others.
void open_report(State& state, const ReportLink& link);

/// A place in a report, with what is known of it there.
struct ReportPlace {
  int frame = 0;
  int plane = 0;             // 0: the frame alone
  bool of_baseline = false;  // whose plane it is
  report::ReportFrame now;
  std::optional<report::ReportFrame> baseline;  // where it has the same input
  std::optional<report::PlaneComparison> fate;  // of the plane since the baseline
  std::optional<planes::PipelineOptions> options_a;
  std::string note;  // what is not as it was, one line
};

struct RunArrival {
  std::int32_t step = -1;  // -1: the last
  std::int32_t plane = -1, voxel = -1;
  bool in_a = false;                  // all of this is of run A
  std::vector<std::uint32_t> marked;  // voxels of the plane that is no more
  std::string message;
};

/// The decision that made the plane what it is, or that lost it. `a` null: there is no such run.
RunArrival arrival_at(const ReportPlace& place, const debug::Run* a, const debug::Run& b);

}  // namespace planescope::desktop
