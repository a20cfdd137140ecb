#include "core/explain/plane_list.hpp"

#include "core/segment/candidate.hpp"

namespace planescope {

void PlaneList::advance_to(std::int32_t step) {
  for (; step_ < step; ++step_) {
    const TraceEvent& event = run_.trace.events[static_cast<std::size_t>(step_)];
    if (event.type == EventType::refine && event.refinement == 7)
      bounds_[event.other] += bounds_[event.plane];
    if (event.type != EventType::found && event.type != EventType::merge) continue;
    if (event.type == EventType::found) bounds_.emplace_back();
    if (event.node < 0) continue;  // a part split off
    bounds_[event.plane] +=
        fit_label(run_.octree(), event.node, event.label, run_.segment_options.use_labels).bounds;
  }
}

MeasuredPlane PlaneList::measured(std::int32_t plane) const {
  const PlaneChange& change = at(plane);
  return planescope::measured(run_, change.fit, change.moments, bounds_[plane]);
}

MeasuredPlane measured(const Run& run,
                       const PlaneFit& fit,
                       const Moments& moments,
                       const Bounds& bounds) {
  const NoiseModel& noise = run.segmentation.noise;
  const double range = (fit.centroid - run.subject->prepared.sensor()).norm();
  return {fit, moments, normal_uncertainty(fit, noise.sigma(range)), noise.tau(range), bounds};
}

std::vector<std::int32_t> planes_of_points(const Run& run, std::int32_t step) {
  std::vector<std::int32_t> plane_of;
  plane_of.reserve(run.octree().order.size());
  for (const std::uint32_t input : run.octree().order)
    plane_of.push_back(run.timeline.point_at(static_cast<std::int32_t>(input), step).plane);
  return plane_of;
}

}  // namespace planescope
