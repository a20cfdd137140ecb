#pragma once

// The page's pieces: data for its templates. Included by report_html*.cpp only.

#include "core/report/page/report_html_parts.hpp"
#include "core/report/page/report_html_plan.hpp"

namespace planescope::report::html {

struct PageSource {
  const Report& report;
  const std::filesystem::path& dir;  // where the pictures' copies lie
  const PagePlan& plan;

  const ReportRecording& recording_of(const PageFrame& frame) const {
    return report.recordings[frame.recording];
  }
  bool has_metrics() const;
  bool has_baseline() const { return report.judgement && report.judgement->baseline; }
};

/// Of report_page.mustache: the verdict, what differs, the worst frames, the totals.
void set_verdict(const PageSource& page, Data& data);

/// Data of report_row.mustache.
Data row_data(const PageSource& page, const PageFrame& frame);
/// "failed", for people and for CSS.
const char* name_of(Standing standing);
/// "Frame 12", "Frame 12 of a.bag".
std::string title_of(const PageSource& page, const PageFrame& frame);
/// Entries `source`, `href`, `alt` of a frame's thumbnails; at most `most`.
Data thumbnails(const PageSource& page, const PageFrame& frame, std::size_t most);

/// Data of report_recording.mustache: facts, warnings, how its frames go.
Data recording_data(const PageSource& page, std::size_t recording);
/// All frames' sources of gravity, each once, as HTML.
std::string gravity_summary(const std::vector<ReportRecording>& recordings);

/// Data of report_frame.mustache.
Data frame_data(const PageSource& page, const PageFrame& frame);
/// The part of it that compares the frame with the baseline.
void set_comparison(const PageSource& page, const PageFrame& frame, Data& data);

/// Planes of a compared frame then and now, as sources of images; empty for clouds.
struct PlaneMaps {
  std::string baseline, now;
  int width = 0, height = 0;
};
PlaneMaps plane_maps(const PageFrame& frame);
/// "2 lost, 1 gained"; "none" where all planes are as they were.
std::string changes_text(const PageFrame& frame);

/// Of report_end.mustache: how near to their thresholds decisions fell.
void set_histograms(const PageSource& page, Data& data);
/// Of the same: what one needs to make the report again.
void set_record(const PageSource& page, Data& data);

}  // namespace planescope::report::html
