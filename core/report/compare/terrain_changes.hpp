#pragma once

// What became of what one can stand on since the baseline, in words.

#include <string>
#include <vector>

#include "core/report/compare/compare_reports.hpp"

namespace planescope::report {

/// "4 steps up, rise 170 mm, going 289 mm in the baseline, 3 steps up, ... now"; empty: both tell
/// of the same, or one is not known.
std::string flights_change(const FrameComparison& frame);
/// "0.43 m2 in the baseline, 0.12 m2 now", and each plane that is no longer steppable, and why, or
/// has become so; empty as above, and where one was without a foot.
std::vector<std::string> steppable_changes(const FrameComparison& frame);
/// All of it, with kerbs and ramps: a sentence each.
std::vector<std::string> terrain_changes(const FrameComparison& frame);

/// "3 of 5 planes are steppable"; "no stairs are found".
std::string steppable_text(const ReportFrame& frame);
std::string flights_text(const ReportFrame& frame);

}  // namespace planescope::report
