#pragma once

// A frame in report.json, written and read. Internal to core/report.

#include <nlohmann/json_fwd.hpp>

#include "core/report/data/json_place.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::report {

/// To a nanometre, which is far below what any sensor tells; never minus zero.
double rounded(double value);
nlohmann::ordered_json vector_json(const Vec3d& v);  // rounded
nlohmann::ordered_json text_or_null(const std::string& text);

/// All of it but its timings. `ours`: with what the octree's traversal tells.
nlohmann::ordered_json frame_json(const ReportFrame& frame, bool ours);
nlohmann::ordered_json metrics_json(const planes::Metrics& metrics);
/// Of its timings and its reference work.
nlohmann::ordered_json timings_json(const ReportFrame& frame);

/// These throw Error naming the place. What the file does not hold, hulls and the noise elsewhere
/// than at 1 m, is not there.
ReportFrame read_frame(const JsonPlace& place);
void read_timings(const JsonPlace& place, ReportFrame& frame);

// Parts of it, for reports of earlier versions as well.
PlaneSummary read_plane(const JsonPlace& place, int id);
RegionSample read_regions(const JsonPlace& place, int planes);
planes::Metrics read_metrics(const JsonPlace& place);  // without pq: NaN

}  // namespace planescope::report
