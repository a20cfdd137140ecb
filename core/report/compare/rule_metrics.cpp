// Metrics for rules: changes of planes and frames since the baseline, and figures of a frame from
// the same table as for the page and frames.csv.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/report/compare/rules.hpp"

namespace planescope::report {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

template <auto kField>
double of_metrics(const ReportFrame& frame) {
  return frame.metrics ? frame.metrics.value().*kField : kNone;
}

template <auto kField>
double of_tracks(const ReportFrame& frame) {
  return frame.tracks ? static_cast<double>(frame.tracks.value().*kField) : kNone;
}

std::string flights_now(const FrameComparison& frame) { return flights_text(*frame.now); }

/// nullopt for frames that are missing, refused, or have no such value.
std::optional<double> value_in(const FrameMetric& metric, const ReportFrame* frame) {
  const double value = frame && frame->refused.empty() ? metric.value(*frame) : kNone;
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

/// Adds the rules for a frame's figure: its value and, if there is one, its change.
void add_rules(const FrameMetric& m, std::vector<RuleMetric>& all) {
  all.push_back({.name = m.name,
                 .unit = m.unit,
                 .sentence = m.sentence,
                 .meaning = m.meaning,
                 .fold = m.fold,
                 .need = m.need,
                 .value = [&m](const FrameComparison& frame) { return value_in(m, frame.now); },
                 .why = m.why});
  if (!m.change.name) return;
  all.push_back({.name = m.change.name,
                 .unit = all.back().unit == "%" ? "percentage points" : m.unit,
                 .sentence = std::string(m.change.what) + " changed by {n}",
                 .meaning = std::string(m.change.meaning) + ", change from the baseline",
                 .needs_baseline = true,
                 .fold = m.fold,
                 .need = m.need,
                 .value = [&m](const FrameComparison& frame) -> std::optional<double> {
                   if (frame.fate != FrameFate::compared) return std::nullopt;
                   const auto is = value_in(m, frame.now), was = value_in(m, frame.baseline);
                   return is && was ? std::optional(*is - *was) : std::nullopt;
                 },
                 .why = m.change.why});
}

/// Adds "plane 3 of the baseline (margin 0.02)" for each undecided plane of these.
void add_undecided(const ReportFrame& frame,
                   const std::vector<int>& ids,
                   const char* of,
                   std::vector<std::string>& texts) {
  for (const int id : ids) {
    if (id < 1) continue;
    const planes::PlaneSummary& plane = frame.planes.at(static_cast<std::size_t>(id) - 1).summary;
    std::string text = fmt::format("plane {}{} (margin {:.2g})", id, of, plane.margin);
    if (plane.undecided && std::ranges::count(texts, text) == 0) texts.push_back(std::move(text));
  }
}

void add_undecided(const FrameComparison& frame,
                   const PlaneComparison& plane,
                   std::vector<std::string>& texts) {
  const bool split = plane.fate == PlaneFate::split;
  std::vector<int> was = {plane.baseline}, is = {plane.now};
  std::vector<int>& with_others = split ? is : was;
  with_others.insert(with_others.end(), plane.others.begin(), plane.others.end());
  add_undecided(*frame.baseline, was, " of the baseline", texts);
  add_undecided(*frame.now, is, "", texts);
}

RuleMetric planes_with(PlaneFate fate, const char* name, const char* sentence, const char* says) {
  const auto count = [fate](bool all) {
    return [=](const FrameComparison& frame) -> std::optional<double> {
      if (frame.fate != FrameFate::compared) return std::nullopt;
      return std::ranges::count_if(frame.planes, [&](const PlaneComparison& plane) {
        return plane.fate == fate && (all || !plane.undecided);
      });
    };
  };
  const auto undecided = [fate](const FrameComparison& frame) {
    std::vector<std::string> texts;
    for (const PlaneComparison& plane : frame.planes)
      if (plane.fate == fate) add_undecided(frame, plane, texts);
    return fmt::format("{}", fmt::join(texts, ", "));
  };
  return {.name = name,
          .unit = "planes",
          .sentence = sentence,
          .meaning = says,
          .needs_baseline = true,
          .fold = RuleFold::sum,
          .value = count(false),
          .total = [](const FrameComparison& frame) -> double {
            return frame.fate == FrameFate::compared
                       ? static_cast<double>(frame.baseline->planes.size())
                       : 0;
          },
          .with_undecided = count(true),
          .undecided = undecided};
}

/// The largest change of planes in both runs. `scale`: from the member's unit to `unit`.
RuleMetric farthest(double PlaneComparison::*change,
                    double scale,
                    const char* name,
                    const char* unit,
                    const char* verb) {
  const auto most_of = [change](const FrameComparison& frame, bool all) {
    const PlaneComparison* most = nullptr;  // null: no plane has changed
    for (const PlaneComparison& plane : frame.planes)
      if (plane.fate <= PlaneFate::moved && (all || !plane.undecided) &&
          plane.*change > (most ? most->*change : 0))
        most = &plane;
    return most;
  };
  const auto largest = [=](bool all) {
    return [=](const FrameComparison& frame) -> std::optional<double> {
      if (frame.fate != FrameFate::compared) return std::nullopt;
      const PlaneComparison* most = most_of(frame, all);
      return most ? scale * (most->*change) : 0;
    };
  };
  const auto undecided = [=](const FrameComparison& frame) {
    std::vector<std::string> texts;
    if (const PlaneComparison* most = most_of(frame, true)) add_undecided(frame, *most, texts);
    return fmt::format("{}", fmt::join(texts, ", "));
  };
  return {.name = name,
          .unit = unit,
          .sentence = fmt::format("a plane {} by {{n}}", verb),
          .meaning = fmt::format("the most that any plane {}", verb),
          .needs_baseline = true,
          .fold = RuleFold::largest,
          .value = largest(false),
          .with_undecided = largest(true),
          .undecided = undecided};
}

RuleMetric frames_where(std::optional<bool> (*is_so)(const FrameComparison&),
                        const char* name,
                        const char* sentence,
                        const char* says) {
  const auto value = [is_so](const FrameComparison& frame) -> std::optional<double> {
    const auto so = is_so(frame);
    return so ? std::optional<double>(*so) : std::nullopt;
  };
  return {.name = name,
          .unit = "frames",
          .sentence = sentence,
          .meaning = says,
          .needs_baseline = true,
          .fold = RuleFold::sum,
          .value = value,
          .total = [](const FrameComparison&) { return 1.0; }};
}

template <FrameFate kFate>
std::optional<bool> has_fate(const FrameComparison& frame) {
  return frame.baseline ? std::optional(frame.fate == kFate) : std::nullopt;
}

/// nullopt: only in the baseline.
std::optional<bool> is_compared(const FrameComparison& frame) {
  if (!frame.now) return std::nullopt;
  return frame.fate != FrameFate::added && frame.fate != FrameFate::other_input;
}

/// Without labels, metrics that need them could never fail.
std::optional<bool> lost_labels(const FrameComparison& frame) {
  const ReportFrame *before = frame.baseline, *now = frame.now;
  if (!before || !now || !before->refused.empty() || !now->refused.empty()) return std::nullopt;
  return before->metrics && !now->metrics;
}

}  // namespace

const std::vector<FrameMetric>& frame_metrics() {
  using planes::Metrics;
  using enum RuleNeed;
  using enum RuleFold;
  static const std::vector<FrameMetric> all = {
      {"planes",
       "planes",
       "{n} {are} found",
       "planes found",
       [](const ReportFrame& f) { return static_cast<double>(f.planes.size()); },
       nothing,
       sum,
       {},
       {"Planes", "Planes", true}},
      {"on_planes_percent",
       "%",
       "{n} of the points are on planes",
       "points on planes",
       [](const ReportFrame& f) { return f.percent_on_planes(); },
       nothing,
       mean,
       {"on_planes_change", "the share of points on planes", "points on planes"},
       {"Points on planes [%]", "Points on planes"}},
      {"mean_iou",
       "%",
       "the mean IoU with the true planes is {n}",
       "mean IoU with the true planes",
       of_metrics<&Metrics::mean_iou>,
       truth,
       mean,
       {"mean_iou_change", "the mean IoU with the true planes", "mean IoU"},
       {"Mean IoU with the labels [%]", "Mean IoU"},
       "IoU"},
      {"pq",
       "%",
       "the panoptic quality is {n}",
       "panoptic quality",
       of_metrics<&Metrics::pq>,
       truth,
       mean,
       {"pq_change", "the panoptic quality", "panoptic quality"},
       {"Panoptic quality [%]", "Panoptic quality"},
       "PQ"},
      {"point_accuracy",
       "%",
       "{n} of the points are on the right plane",
       "points on the right plane",
       of_metrics<&Metrics::point_accuracy>,
       truth,
       mean,
       {"point_accuracy_change", "the share of points on the right plane", "point accuracy"},
       {},
       "Right"},
      {"alpha_deg",
       "degrees",
       "the mean angle to the true normals is {n}",
       "mean angle to the true normals",
       of_metrics<&Metrics::alpha_deg>,
       truth,
       mean,
       {"alpha_change", "the mean angle to the true normals", "alpha"},
       {"Angle error [\u00b0]", "Angle error"},
       "Angle"},
      {"r_p", "%", "the planes found are {n} of the true ones", "true planes that are found",
       of_metrics<&Metrics::r_p>, truth},
      {"r_m", "%", "{n} of the points are in no plane", "points that are not on any plane",
       of_metrics<&Metrics::r_m>, truth},
      {"steppable_area_m2",
       "m2",
       "the area for the center of a foot is {n}",
       "area on steppable planes where the center of a foot can be placed",
       [](const ReportFrame& f) { return f.terrain ? f.terrain->steppable_area_m2 : kNone; },
       foot,
       mean,
       {"steppable_area_change", "the area for the center of a foot", "steppable_area_m2",
        [](const FrameComparison& frame) {
          return fmt::format("{}", fmt::join(steppable_changes(frame), "; "));
        }},
       {"Steppable area [m\u00b2]", "Steppable area", true},
       nullptr,
       [](const FrameComparison& frame) { return steppable_text(*frame.now); }},
      {"track_breaks",
       "planes",
       "{n} {are} lost from one frame to the next",
       "planes that were found in an earlier frame and are still visible, but are not found in "
       "this one",
       of_tracks<&FrameTracks::breaks>,
       tracks,
       sum,
       {"track_breaks_change", "the planes that are lost from one frame to the next",
        "track_breaks"},
       {"Planes lost from the frame before", "Planes lost", true}},
      {"track_swaps", "planes", "{n} {are} assigned to another plane's track",
       "planes assigned to another plane's track", of_tracks<&FrameTracks::swaps>, tracks, sum},
      {"tracks_kept_percent",
       "%",
       "{n} of the pixels on planes continue in the next frame",
       "pixels on planes that are also found in the next frame",
       of_tracks<&FrameTracks::kept_percent>,
       tracks,
       mean,
       {},
       {"Pixels on planes that continue [%]", "Pixels that continue"}},
      {"normal_jitter_deg", "degrees", "while the camera is still, normals jitter by {n}",
       "median frame-to-frame change in normals while the camera is still",
       of_tracks<&FrameTracks::normal_jitter_deg>, tracks},
      {"offset_jitter_mm", "mm", "while the camera is still, planes jitter by {n}",
       "median frame-to-frame change in offsets while the camera is still",
       [](const ReportFrame& f) { return 1000 * of_tracks<&FrameTracks::offset_jitter_m>(f); },
       tracks},
      {"stairs_steps",
       "steps",
       "{n} of stairs {are} found",
       "steps in all flights of stairs",
       [](const ReportFrame& f) { return f.terrain ? f.terrain->steps() : kNone; },
       stairs,
       mean,
       {"stairs_steps_change", "the stairs", "stairs_steps", flights_change},
       {"Steps of stairs", "Steps of stairs", true, true},
       nullptr,
       flights_now},
      {"rise_mm",
       "mm",
       "the rise of the stairs is {n}",
       "mean rise of the flight with the most steps",
       [](const ReportFrame& f) {
         const bool has = f.terrain && !f.terrain->flights.empty();
         return has ? 1000 * f.terrain->flights.front().rise_m : kNone;
       },
       stairs,
       mean,
       {"rise_change", "the rise of the stairs", "rise_mm", flights_change},
       {},
       nullptr,
       flights_now},
      {"time_ratio", "",
       "the time from voxel grid to planes is {n} times that of the reference workload",
       "time from voxel grid to planes, relative to the reference workload",
       [](const ReportFrame& f) { return f.time_ratio() > 0 ? f.time_ratio() : kNone; }, timing}};
  return all;
}

const FrameMetric& find_frame_metric(std::string_view name) {
  return *std::ranges::find(frame_metrics(), name, [](const FrameMetric& metric) {
    return std::string_view(metric.name);
  });
}

const std::vector<RuleMetric>& rule_metrics() {
  static const std::vector<RuleMetric> all = [] {
    std::vector<RuleMetric> rules = {
        planes_with(PlaneFate::lost, "planes_lost", "{n} of the baseline {are} gone",
                    "baseline planes that are gone"),
        planes_with(PlaneFate::gained, "planes_gained", "{n} {are} not in the baseline",
                    "planes that are not in the baseline"),
        planes_with(PlaneFate::merged, "planes_merged",
                    "{n} of the baseline {are} merged with others",
                    "baseline planes that are merged with others"),
        planes_with(PlaneFate::split, "planes_split", "{n} of the baseline {are} split",
                    "baseline planes that are split"),
        planes_with(PlaneFate::moved, "planes_moved", "{n} moved by 5 mm or turned by 1 degree",
                    "planes that moved by at least 5 mm or turned by at least 1 degree"),
        planes_with(PlaneFate::resized, "planes_resized",
                    "the area of {n} changed by a quarter or more",
                    "planes whose area changed by a quarter or more"),
        farthest(&PlaneComparison::offset_m, 1000, "offset_mm", "mm", "moved"),
        farthest(&PlaneComparison::angle_deg, 1, "angle_deg", "degrees", "turned"),
        frames_where(is_compared, "frames_compared", "{n} {are} compared with the baseline",
                     "frames that are in the baseline with the same content"),
        frames_where(has_fate<FrameFate::refused>, "frames_refused",
                     "{n} of the baseline {are} rejected",
                     "frames that were processed in the baseline but are rejected now"),
        frames_where(has_fate<FrameFate::missing>, "frames_missing",
                     "{n} of the baseline {are} missing", "frames that are only in the baseline"),
        frames_where(has_fate<FrameFate::other_input>, "inputs_changed",
                     "{n} {have} different pixels or points than in the baseline",
                     "frames whose pixels or points differ from the baseline"),
        frames_where(lost_labels, "labels_missing", "{n} with labels in the baseline {have} none",
                     "frames that had labels in the baseline but have none now")};
    for (const FrameMetric& metric : frame_metrics()) add_rules(metric, rules);
    const FrameMetric& time = frame_metrics().back();
    rules.push_back({.name = "time_growth",
                     .unit = "times",
                     .sentence = "the time from voxel grid to planes is {n} the baseline's",
                     .meaning = "time_ratio, relative to the baseline",
                     .needs_baseline = true,
                     .need = RuleNeed::timing,
                     .value = [&time](const FrameComparison& frame) -> std::optional<double> {
                       const auto now = value_in(time, frame.now);
                       const auto before = value_in(time, frame.baseline);
                       return now && before ? std::optional(*now / *before) : std::nullopt;
                     }});
    return rules;
  }();
  return all;
}

const RuleMetric& find_metric(std::string_view name) {
  return *std::ranges::find(rule_metrics(), name, &RuleMetric::name);
}

}  // namespace planescope::report
