#include "core/report/rules/rule_metrics.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::report {
namespace {

template <PlaneFate kFate>
std::optional<double> planes_with(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared) return std::nullopt;
  return frame.count(kFate);
}

template <FrameFate kFate>
std::optional<double> frames_with(const FrameComparison& frame) {
  if (!frame.baseline) return std::nullopt;
  return frame.fate == kFate ? 1 : 0;
}

/// Of planes that are the same plane in both.
std::optional<double> farthest(const FrameComparison& frame, double PlaneComparison::*value) {
  if (frame.fate != FrameFate::compared) return std::nullopt;
  double most = 0;
  for (const PlaneComparison& plane : frame.planes)
    if (plane.fate <= PlaneFate::moved) most = std::max(most, plane.*value);
  return most;
}

const RecordedFrame* done(const RecordedFrame* frame) {
  return frame && frame->refused.empty() ? frame : nullptr;
}

template <double planes::Metrics::*kValue>
std::optional<double> scored(const FrameComparison& frame) {
  const RecordedFrame* now = done(frame.now);
  if (!now || !now->metrics) return std::nullopt;
  return now->metrics.value().*kValue;
}

template <double planes::Metrics::*kValue>
std::optional<double> score_change(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared || !frame.now->metrics || !frame.baseline->metrics)
    return std::nullopt;
  const double change = (*frame.now->metrics).*kValue - (*frame.baseline->metrics).*kValue;
  if (std::isnan(change)) return std::nullopt;
  return change;
}

std::optional<double> time_ratio(const RecordedFrame* frame) {
  if (!done(frame) || frame->time_ratio <= 0) return std::nullopt;
  return frame->time_ratio;
}

double share_on_planes(const RecordedFrame& frame) {
  return frame.points > 0
             ? 100 * static_cast<double>(frame.points_on_planes) / static_cast<double>(frame.points)
             : 0;
}

/// Labels that are gone: without them no metric that needs labels could fail.
std::optional<double> labels_missing(const FrameComparison& frame) {
  const RecordedFrame *before = done(frame.baseline), *now = done(frame.now);
  if (!before || !now) return std::nullopt;
  return before->metrics && !now->metrics ? 1 : 0;
}

}  // namespace

const std::vector<Metric>& metrics() {
  using enum RuleFold;
  static const std::vector<Metric> all = {
      {{"planes_lost", "planes", "planes of the baseline that are gone", true, false, sum},
       planes_with<PlaneFate::lost>},
      {{"planes_gained", "planes", "planes that the baseline has not", true, false, sum},
       planes_with<PlaneFate::gained>},
      {{"planes_merged", "planes", "planes of the baseline that are one now", true, false, sum},
       planes_with<PlaneFate::merged>},
      {{"planes_split", "planes", "planes of the baseline that are several now", true, false, sum},
       planes_with<PlaneFate::split>},
      {{"planes_moved", "planes", "planes moved by 5 mm or turned by 1 degree", true, false, sum},
       planes_with<PlaneFate::moved>},
      {{"planes_resized", "planes", "planes with a quarter more area, or less", true, false, sum},
       planes_with<PlaneFate::resized>},
      {{"offset_mm", "mm", "the farthest that a plane moved", true, false, largest},
       [](const FrameComparison& frame) {
         std::optional<double> offset = farthest(frame, &PlaneComparison::offset_m);
         if (offset) *offset *= 1000;
         return offset;
       }},
      {{"angle_deg", "degrees", "the farthest that a plane turned", true, false, largest},
       [](const FrameComparison& frame) { return farthest(frame, &PlaneComparison::angle_deg); }},
      {{"frames_refused", "frames", "frames that the baseline processed and this does not", true,
        false, sum},
       frames_with<FrameFate::refused>},
      {{"frames_missing", "frames", "frames that the baseline has alone", true, false, sum},
       frames_with<FrameFate::missing>},
      {{"inputs_changed", "frames", "frames whose pixels or points are not the baseline's", true,
        false, sum},
       frames_with<FrameFate::other_input>},
      {{"labels_missing", "frames", "frames that the baseline has labels for and this has not",
        true, false, sum},
       labels_missing},
      {{"planes", "planes", "planes found", false, false, sum},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (const RecordedFrame* now = done(frame.now))
           return static_cast<double>(now->planes.size());
         return std::nullopt;
       }},
      {{"on_planes_percent", "%", "points on planes", false, false},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (const RecordedFrame* now = done(frame.now)) return share_on_planes(*now);
         return std::nullopt;
       }},
      {{"on_planes_change", "% points", "points on planes, now less the baseline", true, false},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (frame.fate != FrameFate::compared) return std::nullopt;
         return share_on_planes(*frame.now) - share_on_planes(*frame.baseline);
       }},
      {{"mean_iou", "%", "mean IoU with the true planes", false, true},
       scored<&planes::Metrics::mean_iou>},
      {{"pq", "%", "panoptic quality", false, true}, scored<&planes::Metrics::pq>},
      {{"alpha_deg", "degrees", "mean angle to the true normals", false, true},
       scored<&planes::Metrics::alpha_deg>},
      {{"r_p", "%", "planes found of true ones", false, true}, scored<&planes::Metrics::r_p>},
      {{"r_m", "%", "points in no plane", false, true}, scored<&planes::Metrics::r_m>},
      {{"point_accuracy", "%", "points on the right plane", false, true},
       scored<&planes::Metrics::point_accuracy>},
      {{"mean_iou_change", "% points", "mean IoU, now less the baseline", true, true},
       score_change<&planes::Metrics::mean_iou>},
      {{"pq_change", "% points", "panoptic quality, now less the baseline", true, true},
       score_change<&planes::Metrics::pq>},
      {{"alpha_change", "degrees", "alpha, now less the baseline", true, true},
       score_change<&planes::Metrics::alpha_deg>},
      {{"point_accuracy_change", "% points", "point accuracy, now less the baseline", true, true},
       score_change<&planes::Metrics::point_accuracy>},
      {{"time_ratio", "", "time from voxel grid to planes, of that of work timed beside it", false,
        false, mean, true},
       [](const FrameComparison& frame) { return time_ratio(frame.now); }},
      {{"time_growth", "times", "time_ratio, now of the baseline's", true, false, mean, true},
       [](const FrameComparison& frame) -> std::optional<double> {
         const auto now = time_ratio(frame.now), before = time_ratio(frame.baseline);
         if (!now || !before) return std::nullopt;
         return *now / *before;
       }},
  };
  return all;
}

const Metric& find_metric(std::string_view name) {
  return *std::ranges::find(metrics(), name, [](const Metric& m) { return m.metric.name; });
}

const std::vector<RuleMetric>& rule_metrics() {
  static const std::vector<RuleMetric> all = [] {
    std::vector<RuleMetric> result;
    for (const Metric& metric : metrics()) result.push_back(metric.metric);
    return result;
  }();
  return all;
}

}  // namespace planescope::report
