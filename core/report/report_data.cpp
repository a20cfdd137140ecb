#include "core/report/report_data.hpp"

#include <algorithm>

#include "core/pipeline/options_table.hpp"

namespace planescope {
namespace {

void add_to(ReportTotals& totals, const ReportRecording& recording, std::vector<Metrics>& metrics) {
  ++totals.recordings;
  totals.frames_asked += recording.frames_asked;
  for (const ReportFrame& frame : recording.frames) {
    if (!frame.refused.empty()) {
      ++totals.frames_refused;
      continue;
    }
    const int planes = static_cast<int>(frame.planes.size());
    const bool first = totals.frames_done == 0;
    totals.fewest_planes = first ? planes : std::min(totals.fewest_planes, planes);
    totals.most_planes = std::max(totals.most_planes, planes);
    ++totals.frames_done;
    totals.planes += planes;
    totals.points += frame.counts.kept;
    totals.points_on_planes += frame.points_on_planes;
    if (frame.metrics) metrics.push_back(*frame.metrics);
  }
}

}  // namespace

ReportTotals totals_of(const Report& report) {
  ReportTotals totals;
  std::vector<Metrics> metrics;
  for (const ReportRecording& recording : report.recordings) add_to(totals, recording, metrics);
  if (!metrics.empty()) totals.metrics = mean_of(metrics);
  return totals;
}

ReportTotals totals_of(const ReportRecording& recording) {
  ReportTotals totals;
  std::vector<Metrics> metrics;
  add_to(totals, recording, metrics);
  if (!metrics.empty()) totals.metrics = mean_of(metrics);
  return totals;
}

ReportFrame make_report_frame(const Frame& frame,
                              const FrameResult& result,
                              const PipelineOptions& options,
                              const std::vector<std::string>& plane_colors) {
  ReportFrame report;
  report.index = frame.index;
  report.name = frame.name;
  report.timestamp_s = frame.timestamp_s;
  report.gravity = result.gravity;
  report.counts = result.cloud.counts;
  report.voxels = result.voxels.points.size();
  report.segment = result.segmentation.counts;
  report.noise = result.segmentation.noise;
  report.timings = result.timings;
  for (const PlaneSummary& plane : summarize_planes(result, options.cloud.voxel_size_m)) {
    const auto k = static_cast<std::size_t>(plane.id) - 1;
    report.points_on_planes += plane.points;
    ++(plane.label == Label::v ? report.planes_v : report.planes_h);
    report.planes.push_back({plane, k < plane_colors.size() ? plane_colors[k] : "#888888"});
  }
  return report;
}

std::vector<ReportOption> make_report_options(const PipelineOptions& options) {
  PipelineOptions defaults;
  defaults.segment = profile_options(options.segment.profile);
  std::vector<ReportOption> result;
  for (const OptionInfo& info : option_table()) {
    if (!info.matters(options)) continue;
    ReportOption option{info.name, info.unit, info.meaning, info.section, info.get(options), false};
    option.changed = option.value != info.get(defaults);
    result.push_back(std::move(option));
  }
  return result;
}

}  // namespace planescope
