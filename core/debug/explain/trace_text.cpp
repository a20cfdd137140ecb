#include "core/debug/explain/trace_text.hpp"

#include <cmath>

#include "core/debug/filter/filter.hpp"

namespace planescope::debug {
namespace {

/// Together they use every name of docs/filter.md.
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
  lines.title("Changes of points (STEP:PLANE, * unassigned) and the nodes that held them");
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

/// The whole state, counted, at steps from the first to the last.
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
      lines.add("{}: refused: {}", text, problem.message);
      continue;
    }
    const std::vector<std::int32_t> steps = matches_of(run, text);
    lines.add("{}: {}: {}", text, steps.size(), ranges_of(steps));
  }
}

}  // namespace

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
  write_lives(run, lines);
  write_regions(run, pinned, lines);
  write_comparison_with_truth(run, lines);
  if (pinned) write_comparison(run, *pinned, lines);
  return std::move(lines.text);
}

}  // namespace planescope::debug
