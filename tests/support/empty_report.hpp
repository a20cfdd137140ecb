#pragma once

// Minimal reports and planes for report tests.

#include <string>
#include <utility>
#include <vector>

#include "core/report/data/report_data.hpp"

namespace planescope {

/// A report without recordings.
inline report::Report empty_report() {
  report::Report report;
  report.version = "1.2.3";
  report.commit = std::string(40, 'c');
  report.command = "planescope report a.bag";
  report.created_utc = "2024-01-02T03:04:05Z";
  report.classifier = "pca";
  report.options = report::make_report_options({});
  for (std::string& color : report.case_colors) color = "#e69f00";
  return report;
}

/// A level plane of 1 m2 at this height.
inline report::ReportPlane level_plane(int id, double height_m, const std::string& color = "") {
  planes::PlaneSummary plane;
  plane.id = id;
  plane.label = Label::h;
  plane.centroid.z() = plane.offset_m = height_m;
  plane.area_m2 = 1;
  return {plane, color};
}

/// A report that contains only frames, given by the names of their recordings.
inline report::Report report_of_frames(
    const std::vector<std::pair<std::string, std::vector<report::ReportFrame>>>& recordings) {
  report::Report report;
  for (const auto& [name, frames] : recordings) {
    report.recordings.emplace_back().name = name;
    report.recordings.back().frames = frames;
  }
  return report;
}

}  // namespace planescope
