#pragma once

// The files of a report other than report.json (report_json.hpp).

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

#include "core/report/data/report_data.hpp"

namespace planescope::report {

/// One line per frame, with a header.
std::string frames_csv(const Report& report);

/// For CI: each recording is a test suite and each frame a test case, with a failure if it breaks a
/// rule of level error, or an error if it was not processed.
std::string junit_xml(const Report& report);

/// The page as one file. In long reports it embeds the pictures of the first and worst frames,
/// thumbnails of the others, and links to files beside it. `dir` contains the pictures' copies;
/// missing ones become links.
void write_report_page(std::ostream& out, const Report& report, const std::filesystem::path& dir);

/// Writes an animation of the overlays of each recording with several frames: `overview.png` beside
/// its frames' folder. Repeats the previous frame for a damaged copy. Throws Error.
void write_overviews(const std::filesystem::path& dir, const Report& report);
/// Its path relative to the report; empty for recordings without overlays.
std::string overview_of(const ReportRecording& recording);

/// Writes report.json, frames.csv, junit.xml, overviews and index.html into `dir`, which contains
/// the frames' folders. Each file appears only when it is complete. Throws Error naming the file
/// that cannot be written.
void write_report_files(const std::filesystem::path& dir, const Report& report);

// A finished frame on disk. Reports are assembled from these: immediately, when a stopped run is
// resumed, or when the shards of a large run are joined.

/// Writes frame.json and timings.json into `dir`, frame.json last: if it exists, the frame is
/// complete. `key` identifies the source: input, options, build. Throws Error.
void write_frame_record(const std::filesystem::path& dir,
                        const ReportFrame& frame,
                        bool ours,
                        const std::string& key);

/// The record in `dir`; nullopt if there is none, or it has another key. Throws Error naming the
/// file if it is damaged.
std::optional<ReportFrame> find_frame_record(const std::filesystem::path& dir,
                                             const std::string& key);
/// With any key. Throws Error if there is none.
ReportFrame read_frame_record(const std::filesystem::path& dir);

}  // namespace planescope::report
