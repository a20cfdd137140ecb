#pragma once

// Turns the options that a report records back into those that made it.

#include <string>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/data/recorded_report.hpp"

namespace planescope::report {

/// The options that make_report_options() wrote. Those of other methods, which it leaves out, are
/// the defaults; so is what an earlier version did not have. `unknown`: takes the names that this
/// version does not have. Throws Error naming the option whose value it cannot take.
planes::PipelineOptions options_of(const RecordedReport& report, std::vector<std::string>& unknown);

}  // namespace planescope::report
