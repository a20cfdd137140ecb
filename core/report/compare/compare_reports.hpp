#pragma once

// What became of each frame since an earlier report.

#include <string>
#include <vector>

#include "core/report/compare/compare_planes.hpp"
#include "core/report/data/recorded_report.hpp"

namespace planescope::report {

enum class FrameFate : std::uint8_t {
  compared,
  other_input,  // its pixels or points are not those of the baseline's frame
  refused,      // processed in the baseline, now refused
  mended,       // refused in the baseline, now processed
  both_refused,
  added,    // not in the baseline
  missing,  // in the baseline alone
};
const char* to_string(FrameFate fate);

struct FrameComparison {
  FrameFate fate = FrameFate::compared;
  std::string recording;
  int index = 0;
  const RecordedFrame* baseline = nullptr;  // of the reports that were compared; null: not there
  const RecordedFrame* now = nullptr;
  std::vector<PlaneComparison> planes;  // where it was compared

  int count(PlaneFate fate_of_plane) const;
};

struct ReportComparison {
  /// Everything else that is not the same: "option voxel_size_m: 0.02 -> 0.04", "weights: ...".
  std::vector<std::string> differences;
  std::vector<FrameComparison> frames;  // as they are now, then those that are missing
};

/// Recordings are matched by name (those of one name by order), frames by number. The result points
/// into both reports.
ReportComparison compare_reports(const RecordedReport& baseline,
                                 const RecordedReport& now,
                                 const FateLimits& limits = {});

}  // namespace planescope::report
