// Explains which plane a candidate joined and why it did not join the others (Sun et al. 2023,
// Sec. IV-C, or the objective), and which plane a leftover point was assigned to (last paragraph
// of Sec. IV-C).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/debug/explain/explain.hpp"
#include "core/debug/replay/steps.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::debug {
namespace {

PartnerReport report_of(const planes::Pair& pair, const planes::SegmentOptions& options) {
  return {.plane = pair.plane,
          .checks = coplanarity_checks(pair.terms, options),
          .coplanar = pair.coplanar,
          .cost = pair.terms.offset_m};
}

/// Repeats a choice, recording the compared planes and the chosen partner.
template <typename Choose>
std::vector<PartnerReport> compared_partners(const planes::SegmentOptions& options, Choose choose) {
  std::vector<PartnerReport> partners;
  const planes::PairVisitor visitor = [&](const planes::Pair& pair) {
    partners.push_back(report_of(pair, options));
  };
  const std::int32_t chosen = choose(&visitor);
  for (PartnerReport& partner : partners) partner.chosen = partner.plane == chosen;
  return partners;
}

/// Appends the planes after the accepted one, which the choice did not evaluate.
void append_not_evaluated(const planes::SegmentState& state,
                          const planes::Candidate& candidate,
                          std::vector<PartnerReport>& partners) {
  const std::int32_t asked = partners.empty() ? -1 : partners.back().plane;
  for (auto k = asked + 1; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    if (!state.planes[k].alive) continue;
    const planes::Coplanarity terms = planes::coplanarity(state.planes[k].fit, candidate.fit);
    partners.push_back(report_of({k, terms, false}, state.options));
    partners.back().not_evaluated = true;
    partners.back().coplanar = false;
    for (Check& check : partners.back().checks) check = not_evaluated(check);
  }
}

std::vector<PartnerReport> partners_in_list(const planes::SegmentState& state,
                                            const planes::Candidate& candidate) {
  auto partners = compared_partners(state.options, [&](const planes::PairVisitor* visitor) {
    return planes::choose_partner(state, candidate, visitor);
  });
  append_not_evaluated(state, candidate, partners);
  return partners;
}

/// Sorts: the chosen one, coplanar ones by cost, the nearest misses, then those not evaluated.
void sort_for_reading(std::vector<PartnerReport>& partners) {
  const auto key = [](const PartnerReport& p) {
    return std::tuple(!p.chosen, p.not_evaluated, !p.coplanar,
                      p.coplanar ? p.cost : -least_margin(p.checks));
  };
  std::ranges::stable_sort(partners, {}, key);
}

std::string outcome_of(const Run& run, const MergeReport& report, const planes::TraceEvent& event) {
  if (event.type == planes::EventType::merge)
    return fmt::format("merged into {}, {} away", plane_name(run, event.plane),
                       distance_text(event.value));
  return fmt::format(
      "created {}: {}", plane_name(run, event.plane),
      report.partners.empty() ? "no candidate to compare with" : "no coplanar plane");
}

MergeReport explain_candidate(const Run& run, std::int32_t step) {
  const planes::TraceEvent& event = *run.event_at(step);
  StateWalk walk(run);
  const planes::Candidate candidate =
      planes::fit_label(run.octree(), event.node, event.label, run.segment_options.use_labels);

  MergeReport report;
  report.node = event.node;
  report.label = event.label;
  report.points = static_cast<std::uint32_t>(candidate.moments.count);
  report.candidate = candidate.fit;
  report.partners = partners_in_list(walk.advance_to(step - 1), candidate);
  report.outcome = outcome_of(run, report, event);
  return report;
}

MergeReport explain_split(const Run& run, std::int32_t step) {
  const planes::TraceEvent& event = *run.event_at(step);
  MergeReport report;
  report.label = run.timeline.label_of_plane(event.plane);
  report.outcome =
      fmt::format("{} split off {}: {}", plane_name(run, event.plane), plane_name(run, event.other),
                  planes::info_of(event.stage)->why_parted);
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
          .outcome = "created " + plane_name(run, event.plane)};
}

/// Two regions that touch, or that are separated by an occlusion.
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
      "{} ({:.0f} px) merged into {} ({:.0f} px){}: cost {:.3g}, limit {:.3g}",
      plane_name(run, event.plane), plane.moments.count, plane_name(run, event.other),
      other.moments.count, event.stage == planes::Stage::hidden ? " behind an occluder" : "",
      event.value, check.threshold);
  return report;
}

/// The planes alive at this step, with their distances from the point.
std::vector<LeftoverPlane> planes_beside(const planes::SegmentState& state,
                                         std::uint32_t i,
                                         double limit_m,
                                         const char* why_not) {
  std::vector<LeftoverPlane> rows;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k)
    if (state.planes[k].alive)
      rows.push_back({k, std::abs(state.planes[k].fit.distance_m(state.point(i))), limit_m, false,
                      false, why_not});
  return rows;
}

std::vector<LeftoverPlane> planes_for(const Run& run, std::int32_t step, std::uint32_t i) {
  StateWalk walk(run);
  const planes::SegmentState& state = walk.advance_to(step - 1);
  if (run.segment_options.by_objective()) {  // the plane in reach that explains the point best
    const double limit_m = state.noise.tau(0);
    std::vector<LeftoverPlane> rows =
        planes_beside(state, i, limit_m, "another plane explains it better");
    for (LeftoverPlane& row : rows) {
      row.considered = true;
      row.chosen = row.plane == run.event_at(step)->plane;
      if (row.distance_m > limit_m) row.why_not = "too far";
      if (row.chosen) row.why_not.clear();
    }
    return rows;
  }
  std::vector<LeftoverPlane> rows =
      planes_beside(state, i, state.options.leftover_distance_m, "an earlier plane claimed it");
  const planes::PointVisitor visitor = [&](const planes::PointTerms& terms) {
    const auto row = std::ranges::find(rows, terms.plane, &LeftoverPlane::plane);
    row->considered = true;
    row->why_not = terms.passes() ? "" : "too far";
  };
  const planes::PlaneChoice choice = planes::choose_plane(state, i, &visitor);
  for (LeftoverPlane& row : rows) row.chosen = row.plane == choice.plane;
  return rows;
}

std::string outcome_of(const Run& run, const LeftoverReport& report) {
  for (const LeftoverPlane& plane : report.planes)
    if (plane.chosen)
      return fmt::format("assigned to {}, {} away", plane_name(run, plane.plane),
                         distance_text(plane.distance_m));
  if (report.planes.empty()) return "unassigned: there are no planes";
  const LeftoverPlane& nearest = report.planes.front();
  return fmt::format("unassigned: the nearest, {}, is {} away ({}{})",
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
    if (event->type == planes::EventType::found && event->node < 0)
      report = explain_split(run, step);
    else if (event->type == planes::EventType::found && run.segment_options.by_objective())
      report = explain_founded(run, step);
    else if (is_join(*event))
      report = explain_join(run, step);
    else if (event->type == planes::EventType::found || event->type == planes::EventType::merge)
      report = explain_candidate(run, step);
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
