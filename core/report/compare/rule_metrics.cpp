#include "core/report/compare/rule_metrics.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/report/compare/terrain_changes.hpp"

namespace planescope::report {
namespace {

enum class Counted : std::uint8_t { decided, all };

template <PlaneFate kFate, Counted kCounted = Counted::decided>
std::optional<double> planes_with(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared) return std::nullopt;
  return static_cast<double>(std::ranges::count_if(frame.planes, [](const PlaneComparison& plane) {
    return plane.fate == kFate && (kCounted == Counted::all || !plane.undecided);
  }));
}

/// Adds "plane 3 of the baseline (margin 0.02)" for those of the planes that are undecided.
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

template <PlaneFate kFate>
std::string undecided_with(const FrameComparison& frame) {
  std::vector<std::string> texts;
  for (const PlaneComparison& plane : frame.planes)
    if (plane.fate == kFate) add_undecided(frame, plane, texts);
  return fmt::format("{}", fmt::join(texts, ", "));
}

template <PlaneFate kFate>
MeasuredMetric counting(RuleMetric metric) {
  return {metric, planes_with<kFate>, nullptr, planes_with<kFate, Counted::all>,
          undecided_with<kFate>};
}

template <FrameFate kFate>
std::optional<double> frames_with(const FrameComparison& frame) {
  if (!frame.baseline) return std::nullopt;
  return frame.fate == kFate ? 1 : 0;
}

/// Of planes that are in both runs, the one with the largest such value; null: none has any.
template <double PlaneComparison::*kValue>
const PlaneComparison* farthest(const FrameComparison& frame, Counted counted) {
  const PlaneComparison* most = nullptr;
  for (const PlaneComparison& plane : frame.planes)
    if (plane.fate <= PlaneFate::moved && (counted == Counted::all || !plane.undecided) &&
        plane.*kValue > (most ? most->*kValue : 0))
      most = &plane;
  return most;
}

template <double PlaneComparison::*kValue, int kScale, Counted kCounted>
std::optional<double> largest_of(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared) return std::nullopt;
  const PlaneComparison* most = farthest<kValue>(frame, kCounted);
  return most ? kScale * most->*kValue : 0;
}

template <double PlaneComparison::*kValue>
std::string undecided_farthest(const FrameComparison& frame) {
  std::vector<std::string> texts;
  if (const PlaneComparison* most = farthest<kValue>(frame, Counted::all))
    add_undecided(frame, *most, texts);
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// `kScale`: from the member's unit to the metric's.
template <double PlaneComparison::*kValue, int kScale>
MeasuredMetric largest_change(RuleMetric metric) {
  return {metric, largest_of<kValue, kScale, Counted::decided>, nullptr,
          largest_of<kValue, kScale, Counted::all>, undecided_farthest<kValue>};
}

const ReportFrame* done(const ReportFrame* frame) {
  return frame && frame->refused.empty() ? frame : nullptr;
}

template <double planes::Metrics::*kValue>
std::optional<double> scored(const FrameComparison& frame) {
  const ReportFrame* now = done(frame.now);
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

std::optional<double> time_ratio(const ReportFrame* frame) {
  if (!done(frame) || frame->time_ratio() <= 0) return std::nullopt;
  return frame->time_ratio();
}

/// Labels that are gone: without them no metric that needs labels could fail.
std::optional<double> labels_missing(const FrameComparison& frame) {
  const ReportFrame *before = done(frame.baseline), *now = done(frame.now);
  if (!before || !now) return std::nullopt;
  return before->metrics && !now->metrics ? 1 : 0;
}

/// Where a foot's centre may go; none without a foot.
std::optional<double> steppable_area(const ReportFrame* frame) {
  if (!done(frame) || !frame->terrain || std::isnan(frame->terrain->steppable_area_m2))
    return std::nullopt;
  return frame->terrain->steppable_area_m2;
}

std::optional<double> stairs_steps(const ReportFrame* frame) {
  if (!done(frame) || !frame->terrain) return std::nullopt;
  return frame->terrain->steps();
}

/// Of the flight of most steps.
std::optional<double> rise_mm(const ReportFrame* frame) {
  if (!done(frame) || !frame->terrain || frame->terrain->flights.empty()) return std::nullopt;
  return 1000 * frame->terrain->flights.front().rise_m;
}

template <auto kField>
std::optional<double> of_tracks(const ReportFrame* frame) {
  if (!done(frame) || !frame->tracks) return std::nullopt;
  const auto value = static_cast<double>((*frame->tracks).*kField);
  return std::isnan(value) ? std::nullopt : std::optional(value);
}
std::optional<double> offset_jitter_mm(const ReportFrame* frame) {
  const auto jitter_m = of_tracks<&FrameTracks::offset_jitter_m>(frame);
  return jitter_m ? std::optional(1000 * *jitter_m) : std::nullopt;
}

template <std::optional<double> (*kValue)(const ReportFrame*)>
std::optional<double> now(const FrameComparison& frame) {
  return kValue(frame.now);
}

/// Now less the baseline.
template <std::optional<double> (*kValue)(const ReportFrame*)>
std::optional<double> change(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared) return std::nullopt;
  const auto is = kValue(frame.now), was = kValue(frame.baseline);
  if (!is || !was) return std::nullopt;
  return *is - *was;
}

}  // namespace

const std::vector<MeasuredMetric>& measured_metrics() {
  using enum RuleFold;
  static const std::vector<MeasuredMetric> all = {
      counting<PlaneFate::lost>({"planes_lost", "planes", "{n} of the baseline {are} gone",
                                 "planes of the baseline that are gone", true, false, sum}),
      counting<PlaneFate::gained>({"planes_gained", "planes", "{n} {are} not in the baseline",
                                   "planes that the baseline has not", true, false, sum}),
      counting<PlaneFate::merged>({"planes_merged", "planes",
                                   "{n} of the baseline {are} one with others now",
                                   "planes of the baseline that are one now", true, false, sum}),
      counting<PlaneFate::split>({"planes_split", "planes",
                                  "{n} of the baseline {are} in several now",
                                  "planes of the baseline that are several now", true, false, sum}),
      counting<PlaneFate::moved>({"planes_moved", "planes",
                                  "{n} moved by 5 mm or turned by 1 degree",
                                  "planes moved by 5 mm or turned by 1 degree", true, false, sum}),
      counting<PlaneFate::resized>({"planes_resized", "planes",
                                    "{n} {have} a quarter more area than in the baseline, or less",
                                    "planes with a quarter more area, or less", true, false, sum}),
      largest_change<&PlaneComparison::offset_m, 1000>({"offset_mm", "mm", "a plane moved by {n}",
                                                        "the farthest that a plane moved", true,
                                                        false, largest}),
      largest_change<&PlaneComparison::angle_deg, 1>(
          {"angle_deg", "degrees", "a plane turned by {n}", "the farthest that a plane turned",
           true, false, largest}),
      {{"frames_refused", "frames", "{n} that the baseline processed {are} refused now",
        "frames that the baseline processed and this does not", true, false, sum},
       frames_with<FrameFate::refused>},
      {{"frames_missing", "frames", "{n} of the baseline {are} missing",
        "frames that the baseline has alone", true, false, sum},
       frames_with<FrameFate::missing>},
      {{"inputs_changed", "frames", "{n} {have} other pixels or points than in the baseline",
        "frames whose pixels or points are not the baseline's", true, false, sum},
       frames_with<FrameFate::other_input>},
      {{"labels_missing", "frames", "{n} of the baseline {have} no labels now",
        "frames that the baseline has labels for and this has not", true, false, sum},
       labels_missing},
      {{"planes", "planes", "{n} {are} found", "planes found", false, false, sum},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (const ReportFrame* now = done(frame.now))
           return static_cast<double>(now->planes.size());
         return std::nullopt;
       }},
      {{"on_planes_percent", "%", "{n} of the points are on planes", "points on planes", false,
        false},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (const ReportFrame* now = done(frame.now)) return now->percent_on_planes();
         return std::nullopt;
       }},
      {{"on_planes_change", "% points", "the share of points on planes changed by {n}",
        "points on planes, now less the baseline", true, false},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (frame.fate != FrameFate::compared) return std::nullopt;
         return frame.now->percent_on_planes() - frame.baseline->percent_on_planes();
       }},
      {{"mean_iou", "%", "the mean IoU with the true planes is {n}",
        "mean IoU with the true planes", false, true},
       scored<&planes::Metrics::mean_iou>},
      {{"pq", "%", "the panoptic quality is {n}", "panoptic quality", false, true},
       scored<&planes::Metrics::pq>},
      {{"alpha_deg", "degrees", "the mean angle to the true normals is {n}",
        "mean angle to the true normals", false, true},
       scored<&planes::Metrics::alpha_deg>},
      {{"r_p", "%", "the planes found are {n} of the true ones", "planes found of true ones", false,
        true},
       scored<&planes::Metrics::r_p>},
      {{"r_m", "%", "{n} of the points are in no plane", "points in no plane", false, true},
       scored<&planes::Metrics::r_m>},
      {{"point_accuracy", "%", "{n} of the points are on the right plane",
        "points on the right plane", false, true},
       scored<&planes::Metrics::point_accuracy>},
      {{"mean_iou_change", "% points", "the mean IoU with the true planes changed by {n}",
        "mean IoU, now less the baseline", true, true},
       score_change<&planes::Metrics::mean_iou>},
      {{"pq_change", "% points", "the panoptic quality changed by {n}",
        "panoptic quality, now less the baseline", true, true},
       score_change<&planes::Metrics::pq>},
      {{"alpha_change", "degrees", "the mean angle to the true normals changed by {n}",
        "alpha, now less the baseline", true, true},
       score_change<&planes::Metrics::alpha_deg>},
      {{"point_accuracy_change", "% points",
        "the share of points on the right plane changed by {n}",
        "point accuracy, now less the baseline", true, true},
       score_change<&planes::Metrics::point_accuracy>},
      {{"steppable_area_m2", "m2", "a foot's centre may go on {n}",
        "where a foot's centre may go on steppable planes", false, false, mean, false,
        RuleNeed::foot},
       now<steppable_area>,
       [](const FrameComparison& frame) { return steppable_text(*frame.now); }},
      {{"steppable_area_change", "m2", "where a foot's centre may go changed by {n}",
        "steppable_area_m2, now less the baseline", true, false, mean, false, RuleNeed::foot},
       change<steppable_area>,
       [](const FrameComparison& frame) {
         return fmt::format("{}", fmt::join(steppable_changes(frame), "; "));
       }},
      {{"stairs_steps", "steps", "{n} of stairs {are} found", "steps of all flights of stairs",
        false, false, mean, false, RuleNeed::stairs},
       now<stairs_steps>,
       [](const FrameComparison& frame) { return flights_text(*frame.now); }},
      {{"stairs_steps_change", "steps", "the stairs changed by {n}",
        "stairs_steps, now less the baseline", true, false, mean, false, RuleNeed::stairs},
       change<stairs_steps>,
       flights_change},
      {{"rise_mm", "mm", "the rise of the stairs is {n}", "mean rise of the flight of most steps",
        false, false, mean, false, RuleNeed::stairs},
       now<rise_mm>,
       [](const FrameComparison& frame) { return flights_text(*frame.now); }},
      {{"rise_change", "mm", "the rise of the stairs changed by {n}",
        "rise_mm, now less the baseline", true, false, mean, false, RuleNeed::stairs},
       change<rise_mm>,
       flights_change},
      {{"track_breaks", "planes", "{n} {are} lost from one frame to the next",
        "planes that are in sight, were there before, and are not found", false, false, sum, false,
        RuleNeed::tracks},
       now<of_tracks<&FrameTracks::breaks>>},
      {{"track_breaks_change", "planes",
        "the planes that are lost from one frame to the next changed by {n}",
        "track_breaks, now less the baseline", true, false, sum, false, RuleNeed::tracks},
       change<of_tracks<&FrameTracks::breaks>>},
      {{"track_swaps", "planes", "the place of {n} was taken for another plane's",
        "planes whose place is taken for another track's", false, false, sum, false,
        RuleNeed::tracks},
       now<of_tracks<&FrameTracks::swaps>>},
      {{"tracks_kept_percent", "%", "{n} of the pixels on planes go on in the next frame",
        "pixels on planes whose plane is in the next frame too", false, false, mean, false,
        RuleNeed::tracks},
       now<of_tracks<&FrameTracks::kept_percent>>},
      {{"normal_jitter_deg", "degrees", "while the camera stands still, normals jitter by {n}",
        "median of normals from frame to frame, each frame's share, while the camera stands still",
        false, false, mean, false, RuleNeed::tracks},
       now<of_tracks<&FrameTracks::normal_jitter_deg>>},
      {{"offset_jitter_mm", "mm", "while the camera stands still, planes jitter by {n}",
        "likewise of offsets", false, false, mean, false, RuleNeed::tracks},
       now<offset_jitter_mm>},
      {{"time_ratio", "",
        "the time from voxel grid to planes is {n} times that of the work timed beside it",
        "time from voxel grid to planes, of that of work timed beside it", false, false, mean,
        true},
       [](const FrameComparison& frame) { return time_ratio(frame.now); }},
      {{"time_growth", "times", "the time from voxel grid to planes is {n} the baseline's",
        "time_ratio, now of the baseline's", true, false, mean, true},
       [](const FrameComparison& frame) -> std::optional<double> {
         const auto now = time_ratio(frame.now), before = time_ratio(frame.baseline);
         if (!now || !before) return std::nullopt;
         return *now / *before;
       }},
  };
  return all;
}

const MeasuredMetric& find_metric(std::string_view name) {
  return *std::ranges::find(measured_metrics(), name,
                            [](const MeasuredMetric& m) { return m.metric.name; });
}

}  // namespace planescope::report
