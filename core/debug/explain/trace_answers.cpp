// What core/debug/explain answers about a run, as text.

#include <initializer_list>
#include <numeric>
#include <utility>

#include "core/debug/explain/compare.hpp"
#include "core/debug/explain/explain.hpp"
#include "core/debug/explain/histogram.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/debug/explain/region_decision.hpp"
#include "core/debug/explain/score.hpp"
#include "core/debug/explain/trace_text.hpp"

namespace planescope::debug {
namespace {

constexpr std::size_t kMostOfAKind = 400;  // nodes, events of a type, points of a region
constexpr std::size_t kMostPlaces = 50;    // of each kind whose life is told
constexpr std::size_t kMostSteps = 40;     // that are looked up in another run

template <typename T>
std::vector<T> first_numbers(std::size_t count) {
  std::vector<T> numbers(count);
  std::iota(numbers.begin(), numbers.end(), T{0});
  return numbers;
}

template <typename T>
std::string sampled(const std::vector<T>& some, std::size_t all) {
  return some.size() == all ? fmt::format("all {}", all)
                            : fmt::format("{} of {}, evenly strided", some.size(), all);
}

void write_check(const Check& check, TraceLines& lines) {
  static constexpr const char* kVerdicts[] = {"pass", "fail", "not asked"};
  lines.add("    {} [{}] {} ({}): {} {} {} {}; option {}; {}, margin {}", check.criterion,
            check.equation, check.quantity, check.meaning, exact(check.value), check.op,
            exact(check.threshold), check.unit, check.option.empty() ? "-" : check.option,
            kVerdicts[static_cast<std::size_t>(check.verdict)], exact(check.margin));
}

void write_node(const NodeReport& report, TraceLines& lines) {
  lines.add("node {}: {}; {}; then steps {}", report.node, report.stopped, report.outcome,
            ranges_of(report.outcome_steps));
  for (const Check& check : report.checks) write_check(check, lines);
}

void write_merge(const Run& run, const MergeReport& report, TraceLines& lines) {
  lines.add("step {}: node {}, {}, {} points, {}: {}", report.step, report.node,
            to_string(report.label, "?"), report.points, exact(report.candidate), report.outcome);
  for (const PartnerReport& partner : report.partners) {
    lines.add("  {}:{}{}{} cost {}", plane_name(run, partner.plane),
              partner.coplanar ? " coplanar" : "", partner.chosen ? " chosen" : "",
              partner.never_asked ? " never asked" : "", exact(partner.cost));
    for (const Check& check : partner.checks) write_check(check, lines);
  }
}

void write_leftover(const Run& run, const LeftoverReport& report, TraceLines& lines) {
  lines.add("step {}: point {}: {}", report.step, report.point, report.outcome);
  for (const LeftoverPlane& plane : report.planes)
    lines.add("  {}: distance {}, limit {}{}{}; {}", plane_name(run, plane.plane),
              exact(plane.distance_m), exact(plane.limit_m), plane.considered ? " considered" : "",
              plane.chosen ? " chosen" : "", plane.why_not);
}

std::vector<std::int32_t> steps_of_type(const Run& run, planes::EventType type) {
  std::vector<std::int32_t> steps;
  for (std::int32_t step = 1; step <= run.steps(); ++step)
    if (run.event_at(step)->type == type) steps.push_back(step);
  return steps;
}

/// Calls `write` with some steps of each type.
template <typename Write>
void for_events_of(const Run& run,
                   std::initializer_list<std::pair<planes::EventType, const char*>> types,
                   TraceLines& lines,
                   Write write) {
  for (const auto& [type, name] : types) {
    const std::vector<std::int32_t> all = steps_of_type(run, type);
    const std::vector<std::int32_t> some = strided(all, kMostOfAKind);
    lines.add("# {}: {}", name, sampled(some, all.size()));
    for (const std::int32_t step : some) write(step);
  }
}

void write_life(const Run& run, std::size_t source, TraceLines& lines) {
  lines.add("source {}", source);
  for (const LifeEvent& event : life_of(run, source))
    lines.add("  {} at step {}, node {}, plane {}{}: {}", event.stage, event.step, event.node,
              plane_name(run, event.plane), event.decisive ? ", decisive" : "", event.text);
  const WhyNot why = why_not(run, source);
  lines.add("  why: {} (step {}, node {}, plane {})", why.answer, why.step, why.node,
            plane_name(run, why.plane));
  if (!why.remedy.text.empty() || !why.remedy.option.empty())
    lines.add("  remedy: {} ({}={})", why.remedy.text, why.remedy.option, why.remedy.value);
}

using Region = std::vector<std::uint32_t>;  // voxels

/// [plane], 0: in none.
std::vector<Region> regions_of(std::span<const std::int32_t> plane_of) {
  std::vector<Region> regions(1);
  for (std::size_t voxel = 0; voxel < plane_of.size(); ++voxel) {
    if (plane_of[voxel] < 0) continue;
    const auto plane = static_cast<std::size_t>(plane_of[voxel]);
    if (plane >= regions.size()) regions.resize(plane + 1);
    regions[plane].push_back(static_cast<std::uint32_t>(voxel));
  }
  return regions;
}

std::string decision_text(const RegionDecision& decision) {
  return fmt::format("step {} by voxel {}, {} points, {} alike", decision.step, decision.voxel,
                     decision.points, decision.alike);
}

void write_region(const Run& run,
                  const Run* pinned,
                  const std::string& name,
                  const Region& all,
                  TraceLines& lines) {
  const Region region = strided(all, kMostOfAKind);
  lines.add("{} (points: {}): in plane {}; lost: {}; joined: {}", name, sampled(region, all.size()),
            plane_of_region(run, region), decision_text(loss_of_region(run, region)),
            decision_text(joining_of_region(run, region)));
  if (pinned)
    lines.add("  other than in A: {}", decision_text(first_difference(run, *pinned, region)));
}

void write_result_of(const Comparison& comparison, TraceLines& lines) {
  for (const PlanePair& pair : comparison.planes)
    lines.add("planes {} and {}: IoU {}", pair.a, pair.b, exact(pair.iou));
  const std::vector<std::int32_t> changed(comparison.changed_sources.begin(),
                                          comparison.changed_sources.end());
  lines.add("{} of {} sources changed: {}", changed.size(), comparison.compared_sources,
            ranges_of(changed));
}

void write_same(const char* names, const Run& from, const Run& to, TraceLines& lines) {
  std::string nodes, steps;
  for (const auto node :
       strided(first_numbers<std::int32_t>(from.octree().nodes.size()), kMostOfAKind))
    nodes += fmt::format(" {}:{}", node, same_node(from, node, to));
  for (const auto step :
       strided(first_numbers<std::int32_t>(static_cast<std::size_t>(from.steps()) + 1), kMostSteps))
    steps += fmt::format(" {}:{}", step, same_step(from, step, to));
  lines.add("nodes {}:{}", names, nodes);
  lines.add("steps {}:{}", names, steps);
}

}  // namespace

void write_histograms(const Run& run, TraceLines& lines) {
  lines.title("Histograms (LOW..HIGH: right, wrong, unknown)");
  for (const Histogram& histogram : histograms_of(run)) {
    lines.add("{} ({}) [{}], option {}, threshold {}{}", histogram.title, histogram.quantity,
              histogram.unit, histogram.option, exact(histogram.threshold),
              histogram.logarithmic ? ", logarithmic" : "");
    for (const HistogramBin& bin : histogram.bins)
      lines.add("  {}..{}: {}, {}, {}", exact(bin.low), exact(bin.high), bin.right, bin.wrong,
                bin.unknown);
  }
}

void write_score(const Run& run, TraceLines& lines) {
  const VoxelTruth& truth = run.subject->voxel_truth;
  if (!truth.known()) return;
  const QuickScore score = quick_score(run.segmentation.plane_of, truth);
  const std::vector<TruthVerdict> verdicts = verdicts_of(score, run.segmentation.plane_of, truth);
  lines.title("Against ground truth");
  lines.add("{} detected, mean IoU {}, {} of the points in no plane, {} planes found",
            score.detected, exact(score.mean_iou), exact(score.in_no_plane), score.found_planes);
  for (std::size_t i = 0; i < score.planes.size(); ++i)
    lines.add("truth plane {}, {} points: {}, plane {}, IoU {}", score.planes[i].truth,
              score.planes[i].points, to_string(verdicts[i]), score.planes[i].found,
              exact(score.planes[i].iou));
}

void write_nodes(const Run& run, TraceLines& lines) {
  const std::size_t count = run.octree().nodes.size();
  const auto some = strided(first_numbers<std::int32_t>(count), kMostOfAKind);
  lines.title("Why nodes were decided so: {}", sampled(some, count));
  for (const std::int32_t node : some) write_node(explain_node(run, node), lines);
}

void write_merges(const Run& run, TraceLines& lines) {
  lines.title("Why candidates created planes or were merged");
  for_events_of(run,
                {{planes::EventType::found, "found"},
                 {planes::EventType::merge, "merge"},
                 {planes::EventType::refine, "refine"}},
                lines, [&](std::int32_t step) {
                  const MergeReport report = explain_merge(run, step);
                  if (!report.outcome.empty() || !report.partners.empty())
                    write_merge(run, report, lines);
                });
}

void write_leftovers(const Run& run, TraceLines& lines) {
  lines.title("Why leftover points went where they did");
  for_events_of(run,
                {{planes::EventType::assign, "assign"},
                 {planes::EventType::drop, "drop"},
                 {planes::EventType::refine, "refine"}},
                lines, [&](std::int32_t step) {
                  const LeftoverReport report = explain_leftover(run, step);
                  if (!report.outcome.empty() || !report.planes.empty())
                    write_leftover(run, report, lines);
                });
}

void write_lives(const Run& run, TraceLines& lines) {
  const Subject& subject = *run.subject;
  const auto sources = first_numbers<std::size_t>(subject.point_of_source.size());
  Region in_planes, in_none;
  for (std::size_t voxel = 0; voxel < run.segmentation.plane_of.size(); ++voxel)
    (run.segmentation.plane_of[voxel] > 0 ? in_planes : in_none)
        .push_back(static_cast<std::uint32_t>(voxel));
  lines.title("Histories of sources ({}), of points in planes ({}), in none ({})",
              sampled(strided(sources, kMostPlaces), sources.size()),
              sampled(strided(in_planes, kMostPlaces), in_planes.size()),
              sampled(strided(in_none, kMostPlaces), in_none.size()));
  for (const std::size_t source : strided(sources, kMostPlaces)) write_life(run, source, lines);
  for (const Region& voxels : {in_planes, in_none})
    for (const std::uint32_t voxel : strided(voxels, kMostPlaces))
      write_life(run, source_of_voxel(subject, voxel), lines);
}

void write_regions(const Run& run, const Run* pinned, TraceLines& lines) {
  lines.title("Regions");
  const std::vector<Region> found = regions_of(run.segmentation.plane_of);
  for (std::size_t plane = 0; plane < found.size(); ++plane)
    write_region(run, pinned, fmt::format("plane {}", plane), found[plane], lines);
  if (!run.subject->voxel_truth.known()) return;
  const std::vector<Region> truth = regions_of(run.subject->voxel_truth.plane);
  for (std::size_t plane = 0; plane < truth.size(); ++plane)
    write_region(run, pinned, fmt::format("truth plane {}", plane), truth[plane], lines);
}

void write_comparison(const Run& run, const Run& pinned, TraceLines& lines) {
  const Comparison comparison = compare_runs(pinned, run);
  lines.title("A, the pinned run, beside B, this one");
  lines.add("first different events: step {} of A, step {} of B: {}", comparison.diverging_step_a,
            comparison.diverging_step_b, comparison.divergence);
  for (const NodeChange& node : comparison.nodes)
    lines.add("nodes {} and {}: {} and {}", node.a, node.b, planes::to_string(node.case_a),
              planes::to_string(node.case_b));
  write_result_of(comparison, lines);
  write_same("of A in B", pinned, run, lines);
  write_same("of B in A", run, pinned, lines);
}

void write_comparison_with_truth(const Run& run, TraceLines& lines) {
  if (!run.subject->voxel_truth.known()) return;
  lines.title("Ground truth beside the result");
  write_result_of(compare_with_truth(run), lines);
}

}  // namespace planescope::debug
