#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>

#include "core/report/data/report_data.hpp"

namespace planescope::report {

/// schema "planescope.report/2" (docs/report.md, assets/schemas/report.schema.json). Of all it
/// says, only `created_utc` and `timings` depend on time.
void write_report_json(std::ostream& out, const Report& report);
std::string report_json(const Report& report);

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
/// its frames' folder. Where a copy is damaged the frame before stays. Throws Error.
void write_overviews(const std::filesystem::path& dir, const Report& report);
/// Where it is, relative to the report; empty for recordings without overlays.
std::string overview_of(const ReportRecording& recording);

/// Writes report.json, frames.csv, junit.xml, overviews and index.html into `dir`, where the
/// frames' folders lie; each appears only when it is complete. Throws Error naming the file that
/// cannot be written.
void write_report_files(const std::filesystem::path& dir, const Report& report);

}  // namespace planescope::report
