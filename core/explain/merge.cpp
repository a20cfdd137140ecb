// Which plane a candidate joined, and why none of the others: Sun et al. 2023, Sec. IV-C; R1, R3
// and R7.

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <tuple>

#include "core/explain/check.hpp"
#include "core/explain/explain.hpp"
#include "core/explain/plane_list.hpp"
#include "core/segment/candidate.hpp"
#include "core/segment/cells.hpp"

namespace planescope {
namespace {

PartnerReport by_direction(const PlaneList& planes,
                           std::int32_t plane,
                           const PlaneFit& candidate,
                           const SegmentOptions& options) {
  const Coplanarity terms = coplanarity(planes.fit(plane), candidate);
  PartnerReport partner;
  partner.plane = plane;
  partner.checks = coplanarity_checks(terms, options);
  partner.coplanar = is_coplanar(terms, options);
  partner.cost = terms.offset_m;
  return partner;
}

PartnerReport by_distance(const PlaneList& planes,
                          std::int32_t plane,
                          const MeasuredPlane& candidate,
                          bool with_angle = true) {
  DistanceTerms terms = distance_terms(planes.measured(plane), candidate);
  if (!with_angle) terms.max_angle_deg = 180;
  PartnerReport partner;
  partner.plane = plane;
  partner.checks = distance_checks(terms, with_angle);
  partner.coplanar = terms.passes();
  partner.cost = terms.cost();
  return partner;
}

/// All planes alive, in the order of the list: the paper's question, or R1's.
std::vector<PartnerReport> partners_in_list(const PlaneList& planes,
                                            const Candidate& candidate,
                                            const MeasuredPlane& measured,
                                            const SegmentOptions& options) {
  std::vector<PartnerReport> partners;
  for (std::int32_t k = 0; k < planes.size(); ++k) {
    if (!planes.alive(k)) continue;
    if (!options.r1_merge_by_distance)
      partners.push_back(by_direction(planes, k, candidate.fit, options));
    else if (planes.label(k) == candidate.label)
      partners.push_back(by_distance(planes, k, measured));
  }
  return partners;
}

/// R3: planes with points near the candidate's, whatever their angle, and those that weak
/// candidates founded before it.
std::vector<PartnerReport> partners_of_weak(const Run& run,
                                            const PlaneList& planes,
                                            const Candidate& candidate,
                                            const MeasuredPlane& measured) {
  std::int32_t start = 0;  // the state when the strong ones had been merged
  while (run.trace.events[start].refinement != 3 || run.trace.events[start].type == EventType::wait)
    ++start;
  PlaneList before(run);
  before.advance_to(start);
  const std::int32_t strong = before.size();
  const CellGrid grid = make_cell_grid(run.octree());
  const CellPlanes near = planes_near_cells(grid, planes_of_points(run, start), strong);

  std::vector<std::uint8_t> is_near(strong, 0);
  const OctreeNode& node = run.octree().nodes[candidate.node];
  for (std::uint32_t i = node.begin; i < node.end; ++i)
    if (!run.segment_options.use_labels || run.octree().labels[i] == candidate.label)
      for (const std::int32_t k : near.near(grid.cell_of[i])) is_near[k] = 1;

  std::vector<PartnerReport> partners;
  for (std::int32_t k = 0; k < planes.size(); ++k)
    if (planes.label(k) == candidate.label && (k >= strong || is_near[k]))
      partners.push_back(by_distance(planes, k, measured, k >= strong));
  return partners;
}

/// R7: a plane against those that are no smaller.
std::vector<PartnerReport> partners_of_plane(const PlaneList& planes, std::int32_t plane) {
  const MeasuredPlane small = planes.measured(plane);
  std::vector<PartnerReport> partners;
  for (std::int32_t k = 0; k < planes.size(); ++k)
    if (k != plane && planes.alive(k) && planes.label(k) == planes.label(plane) &&
        planes.measured(k).moments.count >= small.moments.count)
      partners.push_back(by_distance(planes, k, small));
  return partners;
}

/// Marks the first coplanar one, or the cheapest; what stands behind the first was never asked.
void choose(std::vector<PartnerReport>& partners, bool first) {
  PartnerReport* best = nullptr;
  for (PartnerReport& partner : partners) {
    if (first && best) {
      partner.never_asked = true;
      partner.coplanar = false;
      for (Check& check : partner.checks) check = not_asked(check);
    } else if (partner.coplanar && (!best || partner.cost < best->cost)) {
      best = &partner;
    }
  }
  if (best) best->chosen = true;
}

/// The chosen one, coplanar ones by cost, the nearest misses, what was never asked.
void sort_for_reading(std::vector<PartnerReport>& partners) {
  const auto key = [](const PartnerReport& p) {
    return std::tuple(!p.chosen, p.never_asked, !p.coplanar,
                      p.coplanar ? p.cost : -least_margin(p.checks));
  };
  std::stable_sort(partners.begin(), partners.end(),
                   [&](const auto& a, const auto& b) { return key(a) < key(b); });
}

std::string outcome_of(const MergeReport& report, const TraceEvent& event, double sigma_ang) {
  if (event.type == EventType::merge)
    return fmt::format("merged into {}, {} off it", plane_name(event.plane),
                       distance_text(event.value));
  const std::string because =
      report.partners.empty() ? "nothing to compare with" : "no coplanar plane";
  if (event.refinement != 3) return fmt::format("founded {}: {}", plane_name(event.plane), because);
  const std::string known = fmt::format("{} points, normal known to {:.2g}°", report.points,
                                        sigma_ang * 180 / std::numbers::pi);
  if (event.type == EventType::found)
    return fmt::format("founded {}: {}; {}", plane_name(event.plane), because, known);
  return fmt::format("left over: {}, and too weak for a plane of its own ({})", because, known);
}

MergeReport explain_candidate(const Run& run, std::int32_t step) {
  const TraceEvent& event = *run.event_at(step);
  const SegmentOptions& options = run.segment_options;
  const Candidate candidate = fit_label(run.octree(), event.node, event.label, options.use_labels);
  const MeasuredPlane seen = measured(run, candidate.fit, candidate.moments, candidate.bounds);
  PlaneList planes(run);
  planes.advance_to(step - 1);

  MergeReport report;
  report.node = event.node;
  report.label = event.label;
  report.points = static_cast<std::uint32_t>(candidate.moments.count);
  report.candidate = candidate.fit;
  const bool weak = event.refinement == 3;
  report.partners = weak ? partners_of_weak(run, planes, candidate, seen)
                         : partners_in_list(planes, candidate, seen, options);
  choose(report.partners, !weak && options.merge_partner == MergePartner::first);
  report.outcome = outcome_of(report, event, seen.sigma_ang);
  return report;
}

MergeReport explain_second_merge(const Run& run, std::int32_t step) {
  const TraceEvent& event = *run.event_at(step);
  PlaneList planes(run);
  planes.advance_to(step - 1);
  MergeReport report;
  report.label = planes.label(event.plane);
  report.points = static_cast<std::uint32_t>(planes.measured(event.plane).moments.count);
  report.candidate = planes.fit(event.plane);
  report.partners = partners_of_plane(planes, event.plane);
  choose(report.partners, false);
  const double offset = planes.fit(event.other).distance_m(report.candidate.centroid);
  report.outcome = fmt::format("{} merged into {} (R7), {} off it", plane_name(event.plane),
                               plane_name(event.other), distance_text(std::abs(offset)));
  return report;
}

MergeReport explain_split(const Run& run, std::int32_t step) {
  const TraceEvent& event = *run.event_at(step);
  MergeReport report;
  report.label = run.timeline.label_of_plane(event.plane);
  const bool seen = run.segment_options.split_disconnected == SplitRule::seen &&
                    !run.subject->prepared.from_cloud;
  report.outcome =
      fmt::format("{} split off {}: they do not touch{}", plane_name(event.plane),
                  plane_name(event.other), seen ? ", and the sensor looked through the gap" : "");
  return report;
}

}  // namespace

MergeReport explain_merge(const Run& run, std::int32_t step) {
  MergeReport report;
  if (const TraceEvent* event = run.event_at(step)) {
    const bool weak_left = event->type == EventType::leave && event->refinement == 3;
    if (event->type == EventType::found && event->node < 0)
      report = explain_split(run, step);
    else if (event->type == EventType::found || event->type == EventType::merge || weak_left)
      report = explain_candidate(run, step);
    else if (event->type == EventType::refine && event->refinement == 7)
      report = explain_second_merge(run, step);
  }
  sort_for_reading(report.partners);
  report.step = step;
  return report;
}

}  // namespace planescope
