// Which plane a candidate joined, and why none of the others: Sun et al. 2023, Sec. IV-C; R1, R3
// and R7. Which plane a leftover point went to: its last paragraph, and R1's rule.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/debug/explain/explain.hpp"
#include "core/debug/replay/state_walk.hpp"
#include "core/planes/segment/choices.hpp"

namespace planescope::debug {
namespace {

PartnerReport report_of(const planes::Pair& pair, const planes::SegmentOptions& options) {
  const auto* by_distance = std::get_if<planes::DistanceTerms>(&pair.terms);
  return {.plane = pair.plane,
          .checks = by_distance
                        ? distance_checks(*by_distance)
                        : coplanarity_checks(std::get<planes::Coplanarity>(pair.terms), options),
          .coplanar = pair.coplanar,
          .cost = pair.cost};
}

/// Repeats a choice: the planes that it asks about, and the partner that it takes.
template <typename Choose>
std::vector<PartnerReport> partners_asked(const planes::SegmentOptions& options, Choose choose) {
  std::vector<PartnerReport> partners;
  const planes::PairVisitor visitor = [&](const planes::Pair& pair) {
    partners.push_back(report_of(pair, options));
  };
  const std::int32_t chosen = choose(&visitor);
  for (PartnerReport& partner : partners) partner.chosen = partner.plane == chosen;
  return partners;
}

/// The planes behind the one that was taken first: the choice never came to them.
void append_never_asked(const planes::SegmentState& state,
                        const planes::Candidate& candidate,
                        std::vector<PartnerReport>& partners) {
  const planes::MeasuredPlane measured = state.measured(candidate);
  const std::int32_t asked = partners.empty() ? -1 : partners.back().plane;
  for (auto k = asked + 1; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    const std::optional<planes::Pair> pair = planes::compare(state, k, candidate, measured);
    if (!pair) continue;
    partners.push_back(report_of(*pair, state.options));
    partners.back().never_asked = true;
    partners.back().coplanar = false;
    for (Check& check : partners.back().checks) check = not_asked(check);
  }
}

/// The step at which the strong candidates had all been merged: R3's first event follows.
std::int32_t end_of_strong(const Run& run) {
  const auto first = std::ranges::find_if(run.trace.events, [](const planes::TraceEvent& event) {
    return event.stage == planes::Stage::r3_weak_candidates &&
           event.type != planes::EventType::wait;
  });
  return static_cast<std::int32_t>(first - run.trace.events.begin());
}

std::vector<PartnerReport> partners_of_weak(const Run& run,
                                            StateWalk& walk,
                                            std::int32_t step,
                                            const planes::Candidate& candidate) {
  const planes::Neighbourhood strong(walk.advance_to(end_of_strong(run)));
  const planes::SegmentState& state = walk.advance_to(step);
  return partners_asked(state.options, [&](const planes::PairVisitor* visitor) {
    return planes::choose_partner_of_weak(state, candidate, strong, visitor);
  });
}

std::vector<PartnerReport> partners_in_list(const planes::SegmentState& state,
                                            const planes::Candidate& candidate) {
  auto partners = partners_asked(state.options, [&](const planes::PairVisitor* visitor) {
    return planes::choose_partner(state, candidate, visitor);
  });
  append_never_asked(state, candidate, partners);
  return partners;
}

/// R7: a plane against those that are no smaller.
std::vector<PartnerReport> partners_of_plane(const planes::SegmentState& state,
                                             std::int32_t plane) {
  std::vector<std::int32_t> larger;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k)
    if (k != plane && state.planes[k].moments.count >= state.planes[plane].moments.count)
      larger.push_back(k);
  return partners_asked(state.options, [&](const planes::PairVisitor* visitor) {
    return planes::choose_partner_of_plane(state, plane, larger, visitor);
  });
}

/// The chosen one, coplanar ones by cost, the nearest misses, what was never asked.
void sort_for_reading(std::vector<PartnerReport>& partners) {
  const auto key = [](const PartnerReport& p) {
    return std::tuple(!p.chosen, p.never_asked, !p.coplanar,
                      p.coplanar ? p.cost : -least_margin(p.checks));
  };
  std::ranges::stable_sort(partners, {}, key);
}

std::string outcome_of(const Run& run,
                       const MergeReport& report,
                       const planes::TraceEvent& event,
                       double sigma_ang) {
  if (event.type == planes::EventType::merge)
    return fmt::format("merged into {}, {} off it", plane_name(run, event.plane),
                       distance_text(event.value));
  const std::string because =
      report.partners.empty() ? "nothing to compare with" : "no coplanar plane";
  if (event.stage != planes::Stage::r3_weak_candidates)
    return fmt::format("founded {}: {}", plane_name(run, event.plane), because);
  const std::string known = fmt::format("{} points, normal known to {:.2g}°", report.points,
                                        sigma_ang * 180 / std::numbers::pi);
  if (event.type == planes::EventType::found)
    return fmt::format("founded {}: {}; {}", plane_name(run, event.plane), because, known);
  return fmt::format("left over: {}, and too weak for a plane of its own ({})", because, known);
}

MergeReport explain_candidate(const Run& run, std::int32_t step) {
  const planes::TraceEvent& event = *run.event_at(step);
  StateWalk walk(run);
  const planes::Candidate candidate = planes::candidate_of(walk.state(), event.node, event.label);

  MergeReport report;
  report.node = event.node;
  report.label = event.label;
  report.points = static_cast<std::uint32_t>(candidate.moments.count);
  report.candidate = candidate.fit;
  report.partners = event.stage == planes::Stage::r3_weak_candidates
                        ? partners_of_weak(run, walk, step - 1, candidate)
                        : partners_in_list(walk.advance_to(step - 1), candidate);
  report.outcome = outcome_of(run, report, event, candidate.sigma_ang);
  return report;
}

MergeReport explain_second_merge(const Run& run, std::int32_t step) {
  const planes::TraceEvent& event = *run.event_at(step);
  StateWalk walk(run);
  const planes::SegmentState& state = walk.advance_to(step - 1);
  const planes::GrowingPlane& plane = state.planes[event.plane];
  MergeReport report;
  report.label = plane.label;
  report.points = static_cast<std::uint32_t>(plane.moments.count);
  report.candidate = plane.fit;
  report.partners = partners_of_plane(state, event.plane);
  const double offset = state.planes[event.other].fit.distance_m(plane.fit.centroid);
  report.outcome = fmt::format("{} merged into {} (R7), {} off it", plane_name(run, event.plane),
                               plane_name(run, event.other), distance_text(std::abs(offset)));
  return report;
}

MergeReport explain_split(const Run& run, std::int32_t step) {
  const planes::TraceEvent& event = *run.event_at(step);
  MergeReport report;
  report.label = run.timeline.label_of_plane(event.plane);
  const bool seen = event.stage == planes::Stage::split_disconnected &&
                    run.segment_options.split_disconnected.rule == planes::SplitRule::seen &&
                    !run.subject->prepared.from_cloud;
  report.outcome =
      fmt::format("{} split off {}: {}{}", plane_name(run, event.plane),
                  plane_name(run, event.other), planes::refinement_of(event.stage)->why_parted,
                  seen ? ", and the sensor looked through the gap" : "");
  return report;
}

MergeReport explain_founded(const Run& run, std::int32_t step) {
  const planes::TraceEvent& event = *run.event_at(step);
  const NodeFacts& facts = run.facts[event.node];
  return {.node = event.node,
          .label = event.label,
          .points = facts.purity.n_in,
          .candidate = facts.fit,
          .partners = {},
          .outcome = "founded " + plane_name(run, event.plane)};
}

/// Of a depth image: two regions that touch, or that something hides from each other.
MergeReport explain_join(const Run& run, std::int32_t step) {
  const planes::TraceEvent& event = *run.event_at(step);
  const planes::PlaneChange& plane = *run.timeline.plane_at(event.plane, step - 1);
  const planes::PlaneChange& other = *run.timeline.plane_at(event.other, step - 1);
  MergeReport report;
  report.label = plane.label;
  report.points = static_cast<std::uint32_t>(plane.moments.count);
  report.candidate = plane.fit;
  const Check check = join_check(run, event);
  report.partners.push_back({.plane = event.other,
                             .checks = {check},
                             .coplanar = true,
                             .chosen = true,
                             .cost = event.value});
  report.outcome = fmt::format(
      "{} ({:.0f} px) joined {} ({:.0f} px){}: one plane for both costs {:.3g} < {:.3g}",
      plane_name(run, event.plane), plane.moments.count, plane_name(run, event.other),
      other.moments.count,
      event.stage == planes::Stage::hidden ? " behind what hides them from each other" : "",
      event.value, check.threshold);
  return report;
}

/// The last step before the assignment of leftovers that `step` belongs to. R2 makes a second one
/// at the end.
std::int32_t start_of_assignment(const Run& run, std::int32_t step) {
  const auto assigns = [&](std::int32_t at) {
    const planes::EventType type = run.event_at(at)->type;
    return type == planes::EventType::assign || type == planes::EventType::drop;
  };
  while (step > 1 && assigns(step - 1)) --step;
  return step - 1;
}

/// All planes that stand, with what the repeated choice says of them.
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
  const std::string cell = planes::cell_size_text(
      run.octree(), run.octree().cube.max_depth - run.segment_options.noise.neighbour_levels);
  const planes::SegmentState& state = walk.advance_to(step - 1);
  return planes_judged(state, i, "no points of it within " + cell,
                       [&](const planes::PointVisitor* visitor) {
                         return planes::choose_nearest_plane(state, around.near(i), i, visitor);
                       });
}

std::string outcome_of(const Run& run, const LeftoverReport& report) {
  for (const LeftoverPlane& plane : report.planes)
    if (plane.chosen)
      return fmt::format("went to {}, {} off it", plane_name(run, plane.plane),
                         distance_text(plane.distance_m));
  if (report.planes.empty()) return "in no plane: there is none";
  const LeftoverPlane& nearest = report.planes.front();
  return fmt::format("in no plane: the nearest, {}, is {} away ({}{})",
                     plane_name(run, nearest.plane), distance_text(nearest.distance_m),
                     nearest.why_not,
                     nearest.considered ? ", limit " + distance_text(nearest.limit_m) : "");
}

}  // namespace

bool is_join(const planes::TraceEvent& event) {
  return event.type == planes::EventType::refine &&
         (event.stage == planes::Stage::join || event.stage == planes::Stage::hidden);
}

Check join_check(const Run& run, const planes::TraceEvent& event) {
  const planes::ObjectiveOptions& options = run.segment_options.objective;
  const bool hidden = event.stage == planes::Stage::hidden;
  Check check = at_most({planes::to_string(event.stage), "refined", "cost",
                         "misfit of one plane for both, relative to what noise explains", "",
                         hidden ? "hidden_share" : "merge_cost"},
                        event.value, (hidden ? options.hidden_share : 1) * options.merge_cost);
  check.op = "<";
  return check;
}

MergeReport explain_merge(const Run& run, std::int32_t step) {
  MergeReport report;
  if (const planes::TraceEvent* event = run.event_at(step)) {
    const bool weak_left = event->type == planes::EventType::leave &&
                           event->stage == planes::Stage::r3_weak_candidates;
    if (event->type == planes::EventType::found && event->node < 0)
      report = explain_split(run, step);
    else if (event->type == planes::EventType::found && run.is_on_image())
      report = explain_founded(run, step);
    else if (is_join(*event))
      report = explain_join(run, step);
    else if (event->type == planes::EventType::found || event->type == planes::EventType::merge ||
             weak_left)
      report = explain_candidate(run, step);
    else if (event->type == planes::EventType::refine &&
             event->stage == planes::Stage::r7_second_merge)
      report = explain_second_merge(run, step);
  }
  sort_for_reading(report.partners);
  report.step = step;
  return report;
}

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
  report.outcome = outcome_of(run, report);
  return report;
}

}  // namespace planescope::debug
