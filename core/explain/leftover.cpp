// Which plane a leftover point went to: Sun et al. 2023, Sec. IV-C, last paragraph, and R1's rule.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/explain/check.hpp"
#include "core/explain/explain.hpp"
#include "core/explain/plane_list.hpp"
#include "core/segment/cells.hpp"

namespace planescope {
namespace {

/// Step at which the assignment of leftovers that `step` is of begins: R2 has one of its own at the
/// end.
std::int32_t start_of_assignment(const Run& run, std::int32_t step) {
  const auto assigns = [&](std::int32_t at) {
    const EventType type = run.event_at(at)->type;
    return type == EventType::assign || type == EventType::drop;
  };
  while (step > 1 && assigns(step - 1)) --step;
  return step - 1;
}

std::vector<LeftoverPlane> distances(const Run& run, std::int32_t step, const Vec3d& p) {
  std::vector<LeftoverPlane> planes;
  for (std::int32_t k = 0; k < run.timeline.plane_count(); ++k) {
    const PlaneChange* plane = run.timeline.plane_at(k, step);
    if (!plane || !plane->alive) continue;
    LeftoverPlane row;
    row.plane = k;
    row.distance_m = std::abs(plane->fit.distance_m(p));
    planes.push_back(row);
  }
  return planes;
}

/// As written: the first of the list within the distance.
void choose_first(const Run& run, std::vector<LeftoverPlane>& planes) {
  bool found = false;
  for (LeftoverPlane& plane : planes) {
    plane.limit_m = run.segment_options.leftover_distance_m;
    plane.considered = !found;
    plane.chosen = !found && plane.distance_m <= plane.limit_m;
    found = found || plane.chosen;
    if (!plane.considered)
      plane.why_not = "an earlier plane took it";
    else if (!plane.chosen)
      plane.why_not = "too far";
  }
}

/// R1: the nearest within tau of those with points nearby, the other label's moved away a little.
void choose_nearest(const Run& run,
                    std::vector<LeftoverPlane>& planes,
                    std::span<const std::int32_t> near,
                    std::uint32_t i,
                    const Vec3d& p) {
  const NoiseModel& noise = run.segmentation.noise;
  const double range = (p - run.subject->prepared.sensor()).norm();
  LeftoverPlane* best = nullptr;
  for (LeftoverPlane& plane : planes) {
    const bool same = !run.segment_options.use_labels ||
                      run.octree().labels[i] == run.timeline.label_of_plane(plane.plane);
    plane.limit_m = noise.tau(range);
    plane.penalty_m = same ? 0 : noise.other_label_penalty(range);
    plane.considered = std::binary_search(near.begin(), near.end(), plane.plane);
    if (!plane.considered) {
      plane.why_not = "no points of it within 10 cm";
    } else if (plane.distance_m > plane.limit_m) {
      plane.why_not = "too far";
    } else {
      plane.why_not = "another is nearer";
      if (!best || plane.distance_m + plane.penalty_m < best->distance_m + best->penalty_m)
        best = &plane;
    }
  }
  if (!best) return;
  best->chosen = true;
  best->why_not.clear();
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
  const TraceEvent* event = run.event_at(step);
  if (!event || (event->type != EventType::assign && event->type != EventType::drop)) return report;
  report.point = event->point;
  const Octree& octree = run.octree();
  const auto i = static_cast<std::uint32_t>(std::find(octree.order.begin(), octree.order.end(),
                                                      static_cast<std::uint32_t>(event->point)) -
                                            octree.order.begin());
  const Vec3d p = octree.points[i].cast<double>();
  report.planes = distances(run, step - 1, p);
  if (run.segment_options.leftover_rule == LeftoverRule::first) {
    choose_first(run, report.planes);
  } else {
    const CellGrid grid = make_cell_grid(octree);
    const CellPlanes near =
        planes_near_cells(grid, planes_of_points(run, start_of_assignment(run, step)),
                          static_cast<std::size_t>(run.timeline.plane_count()));
    choose_nearest(run, report.planes, near.near(grid.cell_of[i]), i, p);
  }
  std::stable_sort(report.planes.begin(), report.planes.end(),
                   [](const auto& a, const auto& b) { return a.distance_m < b.distance_m; });
  report.outcome = outcome_of(report);
  return report;
}

}  // namespace planescope
