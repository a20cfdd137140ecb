// Writes a run as text: its events and changes, and the explanations of core/debug/explain.

#include "core/debug/explain/trace_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/debug/explain/compare.hpp"
#include "core/debug/explain/explain.hpp"
#include "core/debug/explain/histogram.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/debug/explain/score.hpp"
#include "core/debug/filter/filter.hpp"

namespace planescope::debug {

// ---- Explanations ----

namespace {

/// Text assembled line by line.
struct TraceLines {
  std::string text;

  template <typename... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    text += '\n';
  }
  template <typename... Values>
  void title(fmt::format_string<Values...> format, Values&&... values) {
    text += "\n## ";
    add(format, std::forward<Values>(values)...);
  }
};

/// Prints all digits of a double. "nan" without a sign.
std::string exact(double value) {
  return std::isnan(value) ? "nan" : fmt::format("{:.17g}", value);
}

std::string exact(const Vec3d& v) {
  return fmt::format("({} {} {})", exact(v.x()), exact(v.y()), exact(v.z()));
}

std::string exact(const PlaneFit& fit) {
  return fmt::format("{} fitted, centroid {}, normal {}, eigenvalues {}", exact(fit.count),
                     exact(fit.centroid), exact(fit.normal), exact(fit.eigenvalues));
}

/// Formats ascending numbers as "3-7 9 12-15", or "none".
std::string ranges_of(std::span<const std::int32_t> numbers) {
  std::string text;
  for (std::size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
    for (end = begin + 1; end < numbers.size() && numbers[end] == numbers[end - 1] + 1;) ++end;
    text += begin > 0 ? " " : "";
    text += std::to_string(numbers[begin]);
    if (end - begin > 1) text += fmt::format("-{}", numbers[end - 1]);
  }
  return text.empty() ? "none" : text;
}

/// At most `most` elements of `all`, evenly spaced.
template <typename T>
std::vector<T> strided(const std::vector<T>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

constexpr std::size_t kMostOfAKind = 400;  // nodes, events of a type, points of a region
constexpr std::size_t kMostPlaces = 50;    // of each kind, for histories
constexpr std::size_t kMostSteps = 40;     // looked up in the other run

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
  static constexpr const char* kVerdicts[] = {"pass", "fail", "not evaluated"};
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
              partner.not_evaluated ? " not evaluated" : "", exact(partner.cost));
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

/// Calls `write` for some steps of each type.
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

void write_history(const Run& run, std::size_t source, TraceLines& lines) {
  lines.add("source {}", source);
  for (const HistoryEvent& event : history_of(run, source))
    lines.add("  {} at step {}, node {}, plane {}{}: {}", event.stage, event.step, event.node,
              plane_name(run, event.plane), event.decisive ? ", decisive" : "", event.text);
  const WhyNot why = why_not(run, source);
  lines.add("  why: {} (step {}, node {}, plane {})", why.answer, why.step, why.node,
            plane_name(run, why.plane));
  if (!why.remedy.text.empty() || !why.remedy.option.empty())
    lines.add("  remedy: {} ({}={})", why.remedy.text, why.remedy.option, why.remedy.value);
}

using Region = std::vector<std::uint32_t>;  // voxels

/// Index: plane; 0: unassigned.
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
    lines.add("  differs from A: {}", decision_text(first_difference(run, *pinned, region)));
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

/// Writes nothing without ground truth.
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
  lines.title("Node decisions: {}", sampled(some, count));
  for (const std::int32_t node : some) write_node(explain_node(run, node), lines);
}

void write_merges(const Run& run, TraceLines& lines) {
  lines.title("Candidates that created planes or were merged");
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
  lines.title("Assignment of leftover points");
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

void write_histories(const Run& run, TraceLines& lines) {
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
  for (const std::size_t source : strided(sources, kMostPlaces)) write_history(run, source, lines);
  for (const Region& voxels : {in_planes, in_none})
    for (const std::uint32_t voxel : strided(voxels, kMostPlaces))
      write_history(run, source_of_voxel(subject, voxel), lines);
}

/// Every plane of the result and of the truth, and the unassigned points; compared with `pinned` if
/// not null.
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
  lines.title("Comparison of A (the pinned run) with B (this run)");
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
  lines.title("Ground truth and result");
  write_result_of(compare_with_truth(run), lines);
}

// ---- Events and changes ----

/// Together they use every name in docs/filter.md.
constexpr const char* kTraceFilters[] = {
    "visit && depth>=2 && size>=20",
    "decide && case==I && N_out>theta_n_out && r_out>theta_r_out",
    "case==II || n_in<theta_n_in",
    "case==III && mse>0.8*theta_mse && e_n<2*theta_e_n",
    "case==IV && theta_e_n_m2>0 && n_h>=n_v",
    "at_max_depth",
    "divided && !(n_out>0) && N_in>0",
    "rms>0.001 && rms<1",
    "found && label==h",
    "merge && offset>0.005 && theta_coplane>0 && merge_offset_m>0",
    "assign && distance<0.01 && leftover_distance_m>0",
    "drop && distance<0.05",
    "stage==join && value>0.8*merge_cost",
    "refine || stage==parts || stage==grow || stage==hidden || stage==list && value<worth_px",
    "decide && value>flat && two_planes>0 && filled>0",
    "plane==P1 || plane!=2 && label!=v",
    "point==12 || point==1234",
    "result==1 && step>10",
    "node>=3 && parent<=9 && x<0.5 && y>-0.5 && z>=0",
    "truth.mixed",
    "truth.wrong",
    "truth.plane>=1 && truth.planes>1 && truth.purity<0.9",
};

std::vector<std::int32_t> matches_of(const Run& run, const std::string& text) {
  FilterProblem problem;
  const std::optional<Filter> filter = Filter::parse(text, problem);
  return filter ? filter->matching(run) : std::vector<std::int32_t>();
}

std::string step_or_never(std::int32_t step) {
  return step == planes::kNever ? "never" : std::to_string(step);
}

void write_head(const Run& run, TraceLines& lines) {
  lines.add("planescope trace: method {}, profile {}", planes::to_string(run.options.method),
            planes::to_string(run.options.segment.profile));
  lines.add("{} steps, {} nodes, {} points, {} planes created, {} in the result", run.steps(),
            run.octree().nodes.size(), run.subject->voxel_count(), run.timeline.plane_count(),
            run.segmentation.planes.size());
}

void write_result(const Run& run, TraceLines& lines) {
  lines.title("Planes of the result");
  for (const planes::PlaneRegion& plane : run.segmentation.planes) {
    lines.add("plane {} ({}, {}): {} points, {}", plane.id, plane_name(run, plane.founded),
              to_string(plane.label, "?"), plane.points, exact(plane.fit));
  }
}

void write_events(const Run& run, TraceLines& lines) {
  static constexpr const char* kTypes[] = {"visit",  "decide", "found", "merge",
                                           "assign", "drop",   "refine"};
  lines.title("Events");
  lines.add("step 0: {}", describe_event(run, 0));
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const auto i = static_cast<std::size_t>(step - 1);
    const planes::TraceEvent& e = *run.event_at(step);
    lines.add(
        "step {}: {} | {} by {}, case {}, label {}, node {}, plane {}, other {}, point {}, "
        "value {:.9g}{}",
        step, describe_event(run, step), kTypes[static_cast<std::size_t>(e.type)],
        planes::to_string(e.stage), planes::to_string(static_cast<planes::Case>(e.node_case)),
        to_string(e.label, "?"), e.node, plane_name(run, e.plane), plane_name(run, e.other),
        e.point, e.value, !run.wrong.empty() && run.wrong[i] ? ", wrong" : "");
  }
}

void write_changes_of_planes(const Run& run, TraceLines& lines) {
  lines.title("Changes of planes");
  for (std::int32_t plane = 0; plane < run.timeline.plane_count(); ++plane) {
    lines.add("{} ({}), {} in the result", plane_name(run, plane),
              to_string(run.timeline.label_of_plane(plane), "?"),
              run.timeline.result_of_plane(plane));
    for (const planes::PlaneChange& change : run.timeline.changes_of_plane(plane))
      lines.add("  step {}: {}, into {}, {}", change.step, change.alive ? "alive" : "gone",
                plane_name(run, change.into), exact(change.fit));
  }
}

void write_changes_of_points(const Run& run, TraceLines& lines) {
  lines.title("Changes of points (STEP:PLANE, * unassigned) and the nodes that contained them");
  const auto count = static_cast<std::int32_t>(run.subject->voxel_count());
  for (std::int32_t point = 0; point < count; ++point) {
    std::string changes, path;
    for (const planes::PointChange& change : run.timeline.changes_of_point(point))
      changes += fmt::format(" {}:{}{}", change.step, plane_name(run, change.plane),
                             change.leftover ? "*" : "");
    for (const std::int32_t node : run.timeline.path_of_point(point))
      path += fmt::format(" {}", node);
    lines.add("point {}:{}, nodes{}", point, changes, path);
  }
}

void write_changes_of_nodes(const Run& run, TraceLines& lines) {
  lines.title("Changes of nodes");
  for (std::size_t node = 0; node < run.timeline.queued_at().size(); ++node)
    lines.add("node {}: queued {}, visited {}, decided {}", node,
              step_or_never(run.timeline.queued_at()[node]),
              step_or_never(run.timeline.visited_at()[node]),
              step_or_never(run.timeline.decided_at()[node]));
}

/// Summary of the state at evenly spaced steps, from the first to the last.
void write_states(const Run& run, TraceLines& lines) {
  constexpr int kStates = 20;
  lines.title("States");
  for (int i = 0; i <= kStates; ++i) {
    const auto step = static_cast<std::int32_t>(std::int64_t{run.steps()} * i / kStates);
    int nodes[4] = {}, planes = 0, in_planes = 0, leftovers = 0;
    for (std::size_t n = 0; n < run.octree().nodes.size(); ++n)
      ++nodes[static_cast<int>(run.timeline.node_state(static_cast<std::int32_t>(n), step))];
    for (std::int32_t p = 0; p < run.timeline.plane_count(); ++p) {
      const planes::PlaneChange* plane = run.timeline.plane_at(p, step);
      planes += plane && plane->alive;
    }
    for (std::size_t v = 0; v < run.subject->voxel_count(); ++v) {
      const planes::PointChange point = run.timeline.point_at(static_cast<std::int32_t>(v), step);
      in_planes += point.plane >= 0;
      leftovers += point.leftover;
    }
    lines.add(
        "step {}: nodes {} unborn, {} queued, {} visited, {} settled; {} planes with {} "
        "points; {} unassigned",
        step, nodes[0], nodes[1], nodes[2], nodes[3], planes, in_planes, leftovers);
  }
}

void write_matches(const Run& run, TraceLines& lines) {
  lines.title("Matches of filters");
  for (const char* text : kTraceFilters) {
    FilterProblem problem;
    if (!Filter::parse(text, problem)) {
      lines.add("{}: invalid: {}", text, problem.message);
      continue;
    }
    const std::vector<std::int32_t> steps = matches_of(run, text);
    lines.add("{}: {}: {}", text, steps.size(), ranges_of(steps));
  }
}

}  // namespace

std::string trace_text(const Run& run, const Run* pinned) {
  TraceLines lines;
  write_head(run, lines);
  write_result(run, lines);
  write_score(run, lines);
  write_events(run, lines);
  write_changes_of_planes(run, lines);
  write_changes_of_points(run, lines);
  write_changes_of_nodes(run, lines);
  write_states(run, lines);
  write_matches(run, lines);
  write_histograms(run, lines);
  write_nodes(run, lines);
  write_merges(run, lines);
  write_leftovers(run, lines);
  write_histories(run, lines);
  write_regions(run, pinned, lines);
  write_comparison_with_truth(run, lines);
  if (pinned) write_comparison(run, *pinned, lines);
  return std::move(lines.text);
}

}  // namespace planescope::debug
