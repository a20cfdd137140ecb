#include "core/report/data/report_data.hpp"

#include <algorithm>

#include "core/planes/pipeline/options_table.hpp"
#include "core/report/data/frame_json.hpp"

namespace planescope::report {
namespace {

void add_to(ReportTotals& totals,
            const ReportRecording& recording,
            std::vector<planes::Metrics>& metrics) {
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

std::string in_report_folder(const ReportPicture& picture, const char* ending) {
  const std::filesystem::path pictures = std::filesystem::path(picture.file).parent_path();
  return (pictures.parent_path() / "report" / (picture.name + ending)).generic_string();
}

}  // namespace

std::string copy_of(const ReportPicture& picture) { return in_report_folder(picture, ".jpg"); }
std::string thumbnail_of(const ReportPicture& picture) {
  return in_report_folder(picture, ".small.jpg");
}

ReportTotals totals_of(const Report& report) {
  ReportTotals totals;
  std::vector<planes::Metrics> metrics;
  for (const ReportRecording& recording : report.recordings) add_to(totals, recording, metrics);
  if (!metrics.empty()) totals.metrics = planes::mean_of(metrics);
  return totals;
}

ReportTotals totals_of(const ReportRecording& recording) {
  ReportTotals totals;
  std::vector<planes::Metrics> metrics;
  add_to(totals, recording, metrics);
  if (!metrics.empty()) totals.metrics = planes::mean_of(metrics);
  return totals;
}

ReportFrame make_report_frame(const Frame& frame,
                              const planes::FrameResult& result,
                              const planes::PipelineOptions& options) {
  ReportFrame report;
  report.index = frame.index;
  report.name = frame.name;
  report.timestamp_s = frame.timestamp_s;
  report.gravity = result.gravity;
  report.counts = result.cloud.counts;
  report.voxels = result.voxels.points.size();
  report.segment = result.segmentation.counts;
  const planes::NoiseModel& noise = result.segmentation.noise;
  report.noise = {noise.estimated, noise.by_range,     noise.of_spreads,
                  noise.sigma(1),  noise.theta_rms(1), noise.tau(1)};
  report.timings = result.timings;
  report.regions = sample_regions(frame, result);
  for (PlaneSummary& plane : summarize_planes(result, options.cloud.voxel_size_m)) {
    plane.normal = plane.normal.unaryExpr(&rounded);
    plane.centroid = plane.centroid.unaryExpr(&rounded);
    for (double* value : {&plane.offset_m, &plane.tilt_deg, &plane.rms_m, &plane.area_m2})
      *value = rounded(*value);
    report.points_on_planes += plane.points;
    report.planes_h += plane.label == Label::h;
    report.planes_v += plane.label == Label::v;
    report.planes.push_back({std::move(plane), "#888888"});
  }
  return report;
}

std::vector<ReportOption> make_report_options(const planes::PipelineOptions& options) {
  planes::PipelineOptions defaults;
  defaults.segment = planes::profile_options(options.segment.profile);
  std::vector<ReportOption> result;
  for (const planes::OptionInfo& info : planes::option_table()) {
    if (!info.matters(options) || info.name == "threads") continue;
    ReportOption option{info.name, info.unit, info.meaning, info.section, info.get(options), false};
    option.changed = option.value != info.get(defaults);
    result.push_back(std::move(option));
  }
  return result;
}

}  // namespace planescope::report
