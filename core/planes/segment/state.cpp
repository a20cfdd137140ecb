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
                                Trace* trace,
                                const Measurements& more) {
  assert(points.size() == labels.size());
  SegmentState state{options, sensor, more, trace};
  state.octree = build_octree(points, labels, placed(cube, points, options.cube_anchor));
  if (!more.spreads.empty())
    for (const std::uint32_t i : state.octree.order)
      state.octree.spreads.push_back(more.spreads[i]);
  state.plane_of.assign(points.size(), -1);
  trace_queued(state);
  return state;
}

void SegmentState::measure_reaches() const {
  reaches.reserve(octree.points.size());
  for (std::uint32_t i = 0; i < octree.points.size(); ++i) {
    const double range_m = range(point(i));
    reaches.push_back({noise.tau(range_m), noise.other_label_penalty(range_m)});
  }
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
  state.planes.back().tau_m = state.tau(plane.fit.centroid);
  trace_plane(state, number);
  return number;
}

void fit_again(SegmentState& state, std::int32_t number, const Moments& moments) {
  GrowingPlane& plane = state.planes[number];
  plane.moments = moments;
  plane.fit = fit_plane(moments);
  plane.sigma_ang = state.sigma_ang(plane.fit);
  plane.tau_m = state.tau(plane.fit.centroid);
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
  for (const std::uint32_t i : points) state.octree.add_point(moments, i);
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
  part.sigma_ang = state.sigma_ang(part.fit);
  for (const std::uint32_t i : points) part.bounds.add(state.point(i));
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

std::span<const std::int32_t> planes_of_pixels(const SegmentState& state) {
  // Runs are short. Each is written in pieces of one length, whatever follows it: the next run is
  // written over that.
  constexpr std::size_t kPiece = 8;
  const std::size_t count = state.more.pixels.point.size();
  std::vector<std::int32_t>& planes = state.pixel_planes;
  planes.resize(count + kPiece);
  const std::span<const MeasuredRun> runs = state.pixel_runs();
  for (std::size_t r = 0; r + 1 < runs.size(); ++r) {
    const std::int32_t plane = runs[r].is_measured() ? state.plane_of[runs[r].point] : -1;
    for (std::size_t p = runs[r].begin; p < runs[r + 1].begin; p += kPiece)
      std::fill_n(planes.data() + p, kPiece, plane);
  }
  return std::span(planes).first(count);
}

double typical_area_per_point(const SegmentState& state) {
  std::vector<std::pair<double, double>> planes;  // area per point, points
  double points = 0;
  for (const GrowingPlane& plane : state.planes)
    if (plane.alive) {
      planes.emplace_back(area_per_point(plane.fit), plane.fit.count);
      points += plane.fit.count;
    }
  std::sort(planes.begin(), planes.end());
  double below = 0;
  for (const auto& [area, count] : planes)
    if ((below += count) >= points / 2) return area;
  return 0;
}

}  // namespace planescope::planes
