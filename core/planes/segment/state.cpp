#include "core/planes/segment/state.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "core/planes/segment/criteria.hpp"

namespace planescope::planes {
namespace {

/// The cube as the options want it: where it is, or with its lower corner at the points' own.
Cube placed(const Cube& cube, std::span<const Vec3f> points, CubeAnchor anchor) {
  Cube result = cube;
  if (anchor == CubeAnchor::min_corner && !points.empty()) {
    Vec3f low = points[0];
    for (const Vec3f& p : points) low = low.cwiseMin(p);
    result.min_corner = low.cast<double>();
  }
  return result;
}

void trace_queued(SegmentState& state) {
  if (state.trace) state.trace->queued_at.resize(state.octree.nodes.size(), state.trace->steps());
}

void trace_plane(SegmentState& state, std::int32_t plane) {
  if (state.trace)
    state.trace->planes.push_back({plane, {state.planes[plane], state.trace->steps()}});
}

}  // namespace

SegmentState start_segmentation(std::span<const Vec3f> points,
                                std::span<const Label> labels,
                                const Cube& cube,
                                const Vec3d& sensor,
                                const SegmentOptions& options,
                                Trace* trace) {
  assert(points.size() == labels.size());
  SegmentState state{options, sensor, trace};
  state.octree = build_octree(points, labels, placed(cube, points, options.cube_anchor));
  state.plane_of.assign(points.size(), -1);
  trace_queued(state);
  return state;
}

void visit_node(SegmentState& state, std::int32_t node) {
  log(state, {.type = EventType::visit, .node = node});
  ++state.counts.nodes_visited;
  assert(!state.trace || state.trace->visited_at.size() == static_cast<std::size_t>(node));
  if (state.trace)  // nodes are visited, and then settled, in their order
    state.trace->visited_at.push_back(state.trace->steps());
}

void settle_node(SegmentState& state, std::int32_t index, Case decided) {
  OctreeNode& node = state.octree.nodes[index];
  node.decided = decided;
  ++state.counts.nodes_per_case[static_cast<int>(decided)];
  ++state.counts.nodes_per_case_depth[static_cast<int>(decided)][node.depth];
  if (state.trace) state.trace->decided_at.push_back(state.trace->steps());
}

void divide_node(SegmentState& state, std::int32_t node) {
  divide(state.octree, node);
  trace_queued(state);
}

std::int32_t found_plane(SegmentState& state, const GrowingPlane& plane) {
  const auto number = static_cast<std::int32_t>(state.planes.size());
  state.planes.push_back(plane);
  trace_plane(state, number);
  return number;
}

void fit_again(SegmentState& state, std::int32_t number, const Moments& moments) {
  GrowingPlane& plane = state.planes[number];
  plane.moments = moments;
  plane.fit = fit_plane(moments);
  trace_plane(state, number);
}

void end_plane(SegmentState& state, std::int32_t plane, std::int32_t into) {
  state.planes[plane].alive = false;
  state.planes[plane].into = into;
  trace_plane(state, plane);
}

void join_planes(SegmentState& state,
                 std::int32_t plane,
                 std::int32_t into,
                 std::span<const std::uint32_t> points) {
  grow_plane(state, into, state.planes[plane]);
  end_plane(state, plane, into);
  for (const std::uint32_t i : points) give_point(state, i, into);
}

void drop_plane(SegmentState& state, std::int32_t plane, std::span<const std::uint32_t> points) {
  end_plane(state, plane);
  for (const std::uint32_t i : points) leave_point(state, i);
}

Moments moments_of(const SegmentState& state, std::span<const std::uint32_t> points) {
  Moments moments;
  for (const std::uint32_t i : points) moments.add(state.point(i));
  return moments;
}

std::int32_t found_part(SegmentState& state,
                        Stage stage,
                        std::int32_t plane,
                        std::span<const std::uint32_t> points) {
  GrowingPlane part;
  part.label = state.planes[plane].label;
  part.moments = moments_of(state, points);
  part.fit = fit_plane(part.moments);
  log(state, {.type = EventType::found,
              .stage = stage,
              .label = part.label,
              .plane = static_cast<std::int32_t>(state.planes.size()),
              .other = plane});
  const std::int32_t number = found_plane(state, part);
  for (const std::uint32_t i : points) give_point(state, i, number);
  return number;
}

PlanePoints points_by_plane(const SegmentState& state) {
  PlanePoints result;
  result.first.assign(state.planes.size() + 1, 0);
  for (const std::int32_t plane : state.plane_of)
    if (plane >= 0) ++result.first[plane + 1];
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.points.resize(result.first.back());
  std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
    if (state.plane_of[i] >= 0) result.points[next[state.plane_of[i]]++] = i;
  return result;
}

}  // namespace planescope::planes
