#pragma once

// A report.json of this version, but for its frames.

#include <filesystem>
#include <utility>
#include <vector>

#include "core/report/data/report_data.hpp"

namespace planescope::report {

struct ReportHead {
  Report report;                                    // its recordings without frames
  std::vector<std::pair<std::size_t, int>> frames;  // recording, and the frame's number there
};

/// Throws Error naming the file, the place in it, what was found and what was expected.
ReportHead read_report_head(const std::filesystem::path& file);

}  // namespace planescope::report
