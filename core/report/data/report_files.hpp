#pragma once

// The files of a report beside its report.json (report_json.hpp).

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

#include "core/report/data/report_data.hpp"

namespace planescope::report {

/// One line per frame, with a header.
std::string frames_csv(const Report& report);

/// For CI: each recording a test suite, each frame a test case, a failure where it breaks a rule of
/// level error, an error where it could not be processed.
std::string junit_xml(const Report& report);

/// The page: one file. Of long reports it holds the pictures of the first and of the worst frames,
/// thumbnails of the others, and links to files beside it. `dir`: where the pictures' copies lie;
/// one that is not there is a link.
void write_report_page(std::ostream& out, const Report& report, const std::filesystem::path& dir);

/// An animation of each recording of more than one frame, from its overlays: `overview.png` beside
/// its frames' folder. In place of a damaged copy the previous frame is shown again. Throws Error.
void write_overviews(const std::filesystem::path& dir, const Report& report);
/// Where it is, relative to the report; empty for recordings without overlays.
std::string overview_of(const ReportRecording& recording);

/// Writes report.json, frames.csv, junit.xml, overviews and index.html into `dir`, where the
/// frames' folders lie; each appears only when it is complete. Throws Error naming the file that
/// cannot be written.
void write_report_files(const std::filesystem::path& dir, const Report& report);

// A finished frame on disk. Reports are put together from these: at once, when a stopped one is
// resumed, or when the shards of a large one are joined.

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
