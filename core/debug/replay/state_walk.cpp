#include "core/debug/replay/state_walk.hpp"

namespace planescope::debug {

StateWalk::StateWalk(const Run& run)
    : run_(run), state_{run.segment_options, run.subject->prepared.sensor()} {
  state_.octree = run.octree();
  state_.noise = run.segmentation.noise;
  state_.plane_of.assign(run.octree().order.size(), -1);
}

const planes::SegmentState& StateWalk::advance_to(std::int32_t step) {
  const std::vector<planes::Trace::Point>& points = run_.trace.points;
  for (; points_ < points.size() && points[points_].change.step <= step; ++points_)
    state_.plane_of[points[points_].point] = points[points_].change.plane;
  const std::vector<planes::Trace::Plane>& planes = run_.trace.planes;
  bool joined = false;
  for (; planes_ < planes.size() && planes[planes_].change.step <= step; ++planes_) {
    const auto plane = static_cast<std::size_t>(planes[planes_].plane);
    if (plane == state_.planes.size()) state_.planes.emplace_back();
    state_.planes[plane] = planes[planes_].change;
    joined = joined || planes[planes_].change.into >= 0;
  }
  if (joined)
    for (std::int32_t& plane : state_.plane_of)
      if (plane >= 0) plane = run_.timeline.joined_plane(plane, step);
  return state_;
}

}  // namespace planescope::debug
