#pragma once

// A finished frame of a report, on disk: reports are assembled from these, at once, when a stopped
// one is resumed, or when the shards of a large one are joined.

#include <filesystem>
#include <optional>
#include <string>

#include "core/report/data/report_data.hpp"

namespace planescope::report {

/// Writes frame.json and timings.json into `dir`, frame.json last: where it exists, the whole frame
/// does. `key` tells from what it was made: input, options, build. Throws Error.
void write_frame_record(const std::filesystem::path& dir,
                        const ReportFrame& frame,
                        bool ours,
                        const std::string& key);

/// What lies in `dir`; nullopt where there is none, or of another key. Throws Error naming the file
/// where it is damaged.
std::optional<ReportFrame> find_frame_record(const std::filesystem::path& dir,
                                             const std::string& key);
/// Whatever its key. Throws Error where there is none.
ReportFrame read_frame_record(const std::filesystem::path& dir);

}  // namespace planescope::report
