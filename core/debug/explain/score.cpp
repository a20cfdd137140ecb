// Scores a run against ground truth, groups its unassigned points by reason, and evaluates the
// effect of other options.

#include "core/debug/explain/score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::debug {

// ---- Against ground truth ----

namespace {

TruthMatch match_of(const planes::TruthOverlap& overlap, int t) {
  TruthMatch match{t, 0, 0, static_cast<std::uint32_t>(overlap.truth_size[t])};
  std::uint64_t most = 0;
  for (int f = 1; f <= overlap.found; ++f)
    if (overlap.at(t, f) > most) {
      most = overlap.at(t, f);
      match.found = f;
    }
  if (most > 0) match.iou = overlap.iou(t, match.found);
  return match;
}

TruthVerdict verdict_of(const TruthMatch& match, const planes::TruthOverlap& overlap) {
  constexpr double kPart = 0.1;  // smallest share of a true plane that makes a found plane a part
                                 // of it
  if (match.iou >= kDetectedIou) return TruthVerdict::detected;
  if (match.found == 0) return TruthVerdict::missed;
  for (int t = 1; t <= overlap.truth; ++t)
    if (t != match.truth && overlap.truth_size[t] > 0 &&
        2 * overlap.at(t, match.found) >= overlap.truth_size[t])
      return TruthVerdict::merged;
  int parts = 0;
  for (int f = 1; f <= overlap.found; ++f)
    parts += static_cast<double>(overlap.at(match.truth, f)) >= kPart * match.points;
  const std::uint64_t in_planes = match.points - overlap.at(match.truth, 0);
  return parts >= 2 && 2 * in_planes >= match.points ? TruthVerdict::split : TruthVerdict::missed;
}

}  // namespace

QuickScore quick_score(std::span<const std::int32_t> plane_of, const VoxelTruth& truth) {
  QuickScore score;
  const planes::TruthOverlap overlap = planes::count_truth_overlap(truth.plane, plane_of);
  score.found_planes = overlap.found;
  double in_truth = 0, in_none = 0;
  for (int t = 1; t <= overlap.truth; ++t) {
    if (overlap.truth_size[t] == 0) continue;
    const TruthMatch match = match_of(overlap, t);
    score.planes.push_back(match);
    score.detected += match.iou >= kDetectedIou;
    score.mean_iou += match.iou;
    in_truth += match.points;
    in_none += static_cast<double>(overlap.at(t, 0));
  }
  if (!score.planes.empty()) score.mean_iou /= static_cast<double>(score.planes.size());
  if (in_truth > 0) score.in_no_plane = in_none / in_truth;
  return score;
}

std::vector<TruthVerdict> verdicts_of(const QuickScore& score,
                                      std::span<const std::int32_t> plane_of,
                                      const VoxelTruth& truth) {
  const planes::TruthOverlap overlap = planes::count_truth_overlap(truth.plane, plane_of);
  std::vector<TruthVerdict> verdicts;
  for (const TruthMatch& match : score.planes) verdicts.push_back(verdict_of(match, overlap));
  return verdicts;
}

const char* to_string(TruthVerdict verdict) {
  static constexpr const char* kNames[] = {"detected", "missed", "merged", "split"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::int32_t most_common_plane(std::span<const std::int32_t> planes) {
  std::map<std::int32_t, std::size_t> counts{{0, 0}};
  for (const std::int32_t plane : planes)
    if (plane > 0) ++counts[plane];
  return std::ranges::max_element(counts, {}, &std::pair<const std::int32_t, std::size_t>::second)
      ->first;
}

// ---- Without ground truth ----

namespace {

/// `points`: number of points left over by the same step.
std::string reason_of(const Run& run,
                      const planes::TraceEvent& left,
                      std::size_t points,
                      bool was_assigned) {
  if (left.type != planes::EventType::decide) {
    if (left.stage == planes::Stage::grow) return "regions with too few points";
    if (left.stage == planes::Stage::list) {
      if (!run.is_on_image()) return "dropped planes: below the minimum worth";
      const double least = run.segment_options.objective.worth_px;
      return static_cast<double>(points) < least
                 ? fmt::format("dropped planes: fewer than {:g} px", least)
                 : fmt::format("dropped planes: uneven, worth less than {:g} px", least);
    }
    return std::string("dropped at ") + planes::to_string(left.stage);
  }
  const planes::OctreeNode& node = run.octree().nodes[left.node];
  if (node.decided == planes::Case::I || node.decided == planes::Case::IV)
    return was_assigned ? "too far from any plane" : "no region nearby";
  return std::string("case ") + planes::to_string(node.decided);
}

/// The step at which each voxel was left over for the last time; 0: never.
std::vector<std::int32_t> steps_left(const Run& run) {
  std::vector<std::int32_t> steps(run.subject->voxel_count(), 0);
  for (std::size_t voxel = 0; voxel < steps.size(); ++voxel)
    if (run.segmentation.plane_of[voxel] == 0)
      steps[voxel] = run.timeline.point_at(static_cast<std::int32_t>(voxel), run.steps()).step;
  return steps;
}

/// The middle voxel of the largest group with the same step.
std::int64_t middle_of(const std::vector<std::uint32_t>& voxels,
                       const std::vector<std::int32_t>& step_of) {
  std::map<std::int32_t, std::vector<std::uint32_t>> by_step;
  for (const std::uint32_t voxel : voxels) by_step[step_of[voxel]].push_back(voxel);
  if (by_step.empty()) return -1;
  const auto& most = std::ranges::max_element(by_step, {}, [](const auto& entry) {
                       return entry.second.size();
                     })->second;
  return most[most.size() / 2];
}

}  // namespace

FrameSummary summary_of(const Run& run) {
  const Subject& subject = *run.subject;
  FrameSummary summary;
  summary.planes = static_cast<int>(run.segmentation.planes.size());
  for (const planes::PlaneRegion& plane : run.segmentation.planes)
    summary.undecided += plane.undecided;
  std::vector<std::uint8_t> was_assigned(subject.voxel_count(), 0);  // assignment failed
  for (const planes::TraceEvent& event : run.trace.events)
    if (event.type == planes::EventType::drop && event.point >= 0) was_assigned[event.point] = 1;

  std::map<std::string, Lost> by_reason;
  const std::vector<std::int32_t> left = steps_left(run);
  std::vector<std::size_t> points_left(static_cast<std::size_t>(run.steps()) + 1, 0);
  for (const std::int32_t step : left) ++points_left[static_cast<std::size_t>(step)];
  std::vector<Lost*> lost_by(2 * points_left.size(), nullptr);  // by decision
  for (std::size_t source = 0; source < subject.point_of_source.size(); ++source) {
    if (subject.point_of_source[source] == planes::kNoVoxel) continue;
    ++summary.measured;
    const std::uint32_t voxel = subject.voxel_of_source(source);
    if (voxel == planes::kNoVoxel) {
      ++by_reason["out of range"].sources;
      ++summary.out_of_range;
      if (!subject.frame.is_cloud())
        summary.beyond += subject.frame.depth.data[source] * subject.frame.depth_unit_m >
                          run.options.cloud.max_range_m;
      continue;
    }
    if (const std::int32_t plane = run.segmentation.plane_of[voxel]; plane > 0) {
      ++summary.on_planes;
      summary.on_undecided += run.segmentation.planes[plane - 1].undecided;
      continue;
    }
    // Format the reason once per decision, not once per point.
    Lost*& lost = lost_by[2 * static_cast<std::size_t>(left[voxel]) + was_assigned[voxel]];
    if (!lost)
      lost =
          &by_reason[left[voxel] > 0 ? reason_of(run, *run.event_at(left[voxel]),
                                                 points_left[left[voxel]], was_assigned[voxel] != 0)
                     : run.is_ours() ? "removed from a plane"
                                     : "unassigned"];
    ++lost->sources;
    lost->voxels.push_back(voxel);
  }
  for (auto& [reason, lost] : by_reason) {
    lost.reason = reason;
    std::ranges::sort(lost.voxels);
    lost.voxels.erase(std::unique(lost.voxels.begin(), lost.voxels.end()), lost.voxels.end());
    lost.middle = middle_of(lost.voxels, left);
    summary.lost.push_back(std::move(lost));
  }
  std::ranges::stable_sort(summary.lost, std::greater{}, &Lost::sources);
  return summary;
}

// ---- With other options ----

namespace {

bool is_share(const planes::OptionInfo& info) { return info.range.min == 0 && info.range.max == 1; }

/// From a tenth to ten times the current value, which is in the middle.
std::vector<std::string> values_around(const planes::OptionInfo& info,
                                       const planes::PipelineOptions& options) {
  constexpr int kSide = 12;
  constexpr double kReach = 2.302585092994046;
  const double start = scale_position(info, planes::number_of(info, options));
  std::vector<std::string> values;
  for (int k = -kSide; k <= kSide; ++k)
    values.push_back(k == 0 ? info.get(options) : scale_value(info, start + k * kReach / kSide));
  return values;
}

}  // namespace

std::vector<std::int32_t> planes_with(const Run& run, const planes::PipelineOptions& options) {
  const Subject& subject = *run.subject;
  return planes::find_regions(subject.frame, subject.prepared, options).segmentation.plane_of;
}

double scale_position(const planes::OptionInfo& info, double value) {
  constexpr double kLeast = 1e-4;
  if (!is_share(info)) return std::log(std::max(value, kLeast));
  value = std::clamp(value, kLeast, 1 - kLeast);
  return std::log(value / (1 - value));
}

std::string scale_value(const planes::OptionInfo& info, double position) {
  const double e = std::exp(position);
  // Six digits exceed the resolution of every search, and are readable.
  return planes::number_text(info,
                             std::stod(fmt::format("{:.6g}", is_share(info) ? e / (1 + e) : e)));
}

FixEffect effect_of(const Run& before, const planes::PipelineOptions& after) {
  const Subject& subject = *before.subject;
  const QuickScore was = quick_score(before.segmentation.plane_of, subject.voxel_truth);
  const QuickScore is = quick_score(planes_with(before, after), subject.voxel_truth);
  FixEffect effect{subject.frame.index, was.detected,
                   is.detected,         static_cast<int>(was.planes.size()),
                   was.mean_iou,        is.mean_iou};
  for (std::size_t i = 0; i < was.planes.size(); ++i) {
    const bool had = was.planes[i].iou >= kDetectedIou, has = is.planes[i].iou >= kDetectedIou;
    if (has && !had) effect.recovered.push_back(was.planes[i].truth);
    if (had && !has) effect.broken.push_back(was.planes[i].truth);
  }
  return effect;
}

Sensitivity sensitivity_of(const Run& run, const std::string& option, std::stop_token stop) {
  const planes::OptionInfo& info = planes::find_option(option);
  Sensitivity result{option};
  result.against_truth = run.subject->voxel_truth.known();
  if (!info.is_number()) return result;
  for (const std::string& value : values_around(info, run.options)) {
    if (stop.stop_requested()) break;
    planes::PipelineOptions options = run.options;
    info.set(options, value);
    const double number = planes::number_of(info, options);
    if (!result.values.empty() && number <= result.values.back()) continue;
    const QuickScore score = quick_score(planes_with(run, options), run.subject->voxel_truth);
    result.values.push_back(number);
    result.scores.push_back(result.against_truth ? score.mean_iou : score.found_planes);
  }
  return result;
}

}  // namespace planescope::debug
