// Which plane a leftover point went to: Sun et al. 2023, Sec. IV-C, last paragraph, and R1's rule.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/debug/explain/check.hpp"
#include "core/debug/explain/explain.hpp"
#include "core/debug/replay/state_walk.hpp"
#include "core/planes/segment/choices.hpp"

namespace planescope::debug {
namespace {

/// Step at which the assignment of leftovers that `step` is of begins: R2 has one of its own at the
/// end.
std::int32_t start_of_assignment(const Run& run, std::int32_t step) {
  const auto assigns = [&](std::int32_t at) {
    const planes::EventType type = run.event_at(at)->type;
    return type == planes::EventType::assign || type == planes::EventType::drop;
  };
  while (step > 1 && assigns(step - 1)) --step;
  return step - 1;
}

/// All planes that there are, and what the choice, made again, says of them.
template <typename Choose>
std::vector<LeftoverPlane> planes_judged(const planes::SegmentState& state,
                                         std::uint32_t i,
                                         const std::string& why_not_asked,
                                         Choose choose) {
  const planes::Reach reach = planes::reach_of(state, i, state.options.leftover_rule);
  std::vector<LeftoverPlane> rows;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    if (!state.planes[k].alive) continue;
    const planes::PointTerms terms = planes::point_terms(state, k, i, reach);
    rows.push_back(
        {k, terms.distance_m, terms.limit_m, terms.penalty_m, false, false, why_not_asked});
  }
  const planes::PointVisitor visitor = [&](const planes::PointTerms& terms) {
    const auto row = std::ranges::find(rows, terms.plane, &LeftoverPlane::plane);
    row->considered = true;
    row->why_not = terms.passes() ? "another is nearer" : "too far";
  };
  const planes::PlaneChoice choice = choose(&visitor);
  for (LeftoverPlane& row : rows) {
    row.chosen = row.plane == choice.plane;
    if (row.chosen) row.why_not.clear();
  }
  return rows;
}

std::vector<LeftoverPlane> planes_for(const Run& run, std::int32_t step, std::uint32_t i) {
  StateWalk walk(run);
  if (run.segment_options.leftover_rule == planes::LeftoverRule::first) {
    const planes::SegmentState& state = walk.advance_to(step - 1);
    return planes_judged(state, i, "an earlier plane took it",
                         [&](const planes::PointVisitor* visitor) {
                           return planes::choose_first_plane(state, i, visitor);
                         });
  }
  const planes::Neighbourhood around(walk.advance_to(start_of_assignment(run, step)));
  const double cell_cm =
      100 * run.octree().cube.edge_m /
      std::exp2(run.octree().cube.max_depth - run.segment_options.noise.neighbour_levels);
  const planes::SegmentState& state = walk.advance_to(step - 1);
  return planes_judged(state, i, fmt::format("no points of it within {:.3g} cm", cell_cm),
                       [&](const planes::PointVisitor* visitor) {
                         return planes::choose_nearest_plane(state, around.near(i), i, visitor);
                       });
}

std::string outcome_of(const LeftoverReport& report) {
  for (const LeftoverPlane& plane : report.planes)
    if (plane.chosen)
      return fmt::format("went to {}, {} off it", plane_name(plane.plane),
                         distance_text(plane.distance_m));
  if (report.planes.empty()) return "in no plane: there is none";
  const LeftoverPlane& nearest = report.planes.front();
  return fmt::format("in no plane: the nearest, {}, is {} away ({}{})", plane_name(nearest.plane),
                     distance_text(nearest.distance_m), nearest.why_not,
                     nearest.considered ? ", limit " + distance_text(nearest.limit_m) : "");
}

}  // namespace

LeftoverReport explain_leftover(const Run& run, std::int32_t step) {
  LeftoverReport report;
  report.step = step;
  const planes::TraceEvent* event = run.event_at(step);
  if (!event ||
      (event->type != planes::EventType::assign && event->type != planes::EventType::drop))
    return report;
  report.point = event->point;
  const std::vector<std::uint32_t>& order = run.octree().order;
  const auto at = std::ranges::find(order, static_cast<std::uint32_t>(event->point));
  report.planes = planes_for(run, step, static_cast<std::uint32_t>(at - order.begin()));
  std::ranges::stable_sort(report.planes, {}, &LeftoverPlane::distance_m);
  report.outcome = outcome_of(report);
  return report;
}

}  // namespace planescope::debug
