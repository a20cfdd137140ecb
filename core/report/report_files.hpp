#pragma once

#include <filesystem>
#include <string>

#include "core/report/report_data.hpp"

namespace planescope {

/// schema "planescope.report/1" (docs/report.md, assets/schemas/report.schema.json). Of all it
/// says, only `created_utc` and `timings` depend on time.
std::string report_json(const Report& report);

/// One line per frame, with a header.
std::string frames_csv(const Report& report);

/// The page: everything it shows lies inside it.
std::string report_html(const Report& report);

/// Writes report.json, frames.csv and index.html into `dir`, which exists; each appears only when
/// it is complete. Throws Error naming the file that cannot be written.
void write_report_files(const std::filesystem::path& dir, const Report& report);

}  // namespace planescope
