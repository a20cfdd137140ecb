#pragma once

// A frame in report.json, written and read. Internal to core/report.

#include <nlohmann/json_fwd.hpp>

#include "core/model/json_fields.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::report {

nlohmann::ordered_json metrics_json(const planes::Metrics& metrics);
/// All of it but its timings. `ours`: with what the octree's traversal tells.
nlohmann::ordered_json frame_json(const ReportFrame& frame, bool ours);
/// Of its timings and its reference work.
nlohmann::ordered_json timings_json(const ReportFrame& frame);

/// These throw Error naming the place. Hulls, and the noise elsewhere than at 1 m, are not in the
/// file.
ReportFrame read_frame(const JsonPlace& place, Extent extent);
void read_timings(const JsonPlace& place, ReportFrame& frame);

}  // namespace planescope::report
