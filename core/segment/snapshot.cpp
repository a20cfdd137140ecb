#include "core/segment/snapshot.hpp"

#include "core/segment/state.hpp"

namespace planescope {
namespace {

SegmentSnapshot taken_of(const SegmentState& state) {
  SegmentSnapshot snapshot;
  snapshot.events = state.trace->events.size();
  snapshot.visited = state.counts.nodes_visited;
  snapshot.nodes = state.octree.nodes;
  snapshot.plane_of.assign(state.plane_of.size(), -1);
  snapshot.leftover.assign(state.plane_of.size(), 0);
  for (std::size_t i = 0; i < state.plane_of.size(); ++i) {
    std::int32_t plane = state.plane_of[i];
    while (plane >= 0 && state.planes[plane].into >= 0) plane = state.planes[plane].into;
    snapshot.plane_of[state.octree.order[i]] = plane;
  }
  for (const std::uint32_t i : state.leftovers)
    if (state.plane_of[i] < 0) snapshot.leftover[state.octree.order[i]] = 1;
  for (const GrowingPlane& plane : state.planes)
    snapshot.planes.push_back({plane.label, plane.moments, plane.fit, plane.alive, plane.into});
  return snapshot;
}

}  // namespace

SegmentSnapshot segment_until(std::span<const Vec3f> points,
                              std::span<const Label> labels,
                              const Cube& cube,
                              const Vec3d& sensor,
                              const SegmentOptions& options,
                              std::size_t events,
                              const Measurements& more) {
  Trace trace;
  SegmentState state = start_segmentation(points, labels, cube, sensor, options, &trace, more);
  state.stop_at = events;
  try {
    run_stages(state);
  } catch (const Stopped&) {
    // As asked.
  }
  return taken_of(state);
}

}  // namespace planescope
