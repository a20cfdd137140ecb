#pragma once

// Where in a run a window that was opened from a report begins.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/compare/compare_reports.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::desktop {

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
