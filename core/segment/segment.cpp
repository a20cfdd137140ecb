// Sun et al. 2023, Sec. IV: the method in one function.

#include "core/segment/segment.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>

#include "core/segment/outward.hpp"
#include "core/segment/state.hpp"

namespace planescope {
namespace {

using Clock = std::chrono::steady_clock;

double elapsed_ms(Clock::time_point since) {
  return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
}

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

/// Numbers the planes that are left by size and hands them over with their points.
void conclude(SegmentState& state, Segmentation& result) {
  std::vector<std::uint32_t> points(state.planes.size(), 0);
  for (const std::int32_t plane : state.plane_of)
    if (plane >= 0) ++points[plane];
  std::vector<std::int32_t> order;
  for (std::size_t k = 0; k < state.planes.size(); ++k)
    if (state.planes[k].alive && points[k] > 0) order.push_back(static_cast<std::int32_t>(k));
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return points[a] > points[b]; });

  std::vector<std::int32_t> id(state.planes.size(), 0);
  for (const std::int32_t k : order) {
    const GrowingPlane& plane = state.planes[k];
    PlaneRegion region;
    region.id = static_cast<int>(result.planes.size()) + 1;
    region.label = plane.label;
    region.fit = plane.fit;
    region.points = points[k];
    region.founded = k;
    region.fit.normal = outward_normal(plane.fit, plane.label, state.sensor);
    result.planes.push_back(region);
    id[k] = region.id;
  }
  result.plane_of.assign(state.plane_of.size(), 0);
  for (std::size_t i = 0; i < state.plane_of.size(); ++i) {
    const std::int32_t plane = state.plane_of[i];
    if (plane >= 0) result.plane_of[state.octree.order[i]] = id[plane];
    if (plane < 0 || id[plane] == 0) ++state.counts.unassigned;
  }
  result.octree = std::move(state.octree);
  result.noise = std::move(state.noise);
  result.counts = state.counts;
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
  return state;
}

void run_stages(SegmentState& state) {
  const SegmentOptions& options = state.options;
  state.noise = measure_noise(state.octree, state.sensor, options);
  traverse(state);  // Sec. IV-C, merging (IV-D) as it goes
  if (options.r3_weak_candidates) join_weak_candidates(state);
  if (options.r7_second_merge) merge_planes_again(state);
  if (options.r2_explain_away) prune_explained_planes(state);
  assign_leftovers(state);
  if (options.r6_refit) refit_planes(state);
  if (options.r5_reassign_shared_cells) reassign_shared_points(state);
  if (options.r5_reassign_shared_cells && options.r2_explain_away) drop_emptied_planes(state);
  if (options.split_disconnected != SplitRule::off) split_disconnected_planes(state);
}

Segmentation segment(std::span<const Vec3f> points,
                     std::span<const Label> labels,
                     const Cube& cube,
                     const Vec3d& sensor,
                     const SegmentOptions& options,
                     Trace* trace,
                     const Measurements& more) {
  Segmentation result;
  const auto start = Clock::now();
  SegmentState state = start_segmentation(points, labels, cube, sensor, options, trace, more);
  result.timings.build_ms = elapsed_ms(start);

  const auto built = Clock::now();
  run_stages(state);
  conclude(state, result);
  result.timings.traverse_ms = elapsed_ms(built);
  return result;
}

}  // namespace planescope
