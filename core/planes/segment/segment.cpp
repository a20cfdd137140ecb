// Sun et al. 2023, Sec. IV: the method in one function.

#include "core/planes/segment/segment.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>

#include "core/planes/segment/cloud_regions.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::planes {
namespace {

using Clock = std::chrono::steady_clock;

double elapsed_ms(Clock::time_point since) {
  return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
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
  const auto region_of = [&](std::int32_t k) {
    const GrowingPlane& plane = state.planes[k];
    PlaneRegion region;
    region.label = plane.label;
    region.fit = plane.fit;
    region.points = points[k];
    region.founded = k;
    region.fit.normal = outward_normal(plane.fit, plane.label, state.sensor);
    return region;
  };
  for (const std::int32_t k : order) {
    result.planes.push_back(region_of(k));
    id[k] = result.planes.back().id = static_cast<int>(result.planes.size());
  }
  result.plane_of.assign(state.plane_of.size(), 0);
  for (std::size_t i = 0; i < state.plane_of.size(); ++i) {
    const std::int32_t plane = state.plane_of[i];
    if (plane >= 0) result.plane_of[state.octree.order[i]] = id[plane];
    if (plane < 0 || id[plane] == 0) ++state.counts.unassigned;
  }
  result.octree = std::move(state.octree);
  result.noise = state.noise;
  result.counts = state.counts;
}

}  // namespace

Segmentation segment(std::span<const Vec3f> points,
                     std::span<const Label> labels,
                     const Cube& cube,
                     const Vec3d& sensor,
                     const SegmentOptions& options,
                     Trace* trace) {
  Segmentation result;
  const auto start = Clock::now();
  SegmentState state = start_segmentation(points, labels, cube, sensor, options, trace);
  result.timings.build_ms = elapsed_ms(start);

  const auto built = Clock::now();
  if (options.by_objective()) {
    const CloudScales scales = measure_scales(state, options.objective);
    state.noise = noise_of(scales, options.objective);
    traverse(state);
    find_cloud_regions(state, scales, options.objective);
  } else {
    traverse(state);  // Sec. IV-C, merging (IV-D) as it goes
    assign_leftovers(state);
  }
  conclude(state, result);
  result.timings.traverse_ms = elapsed_ms(built);
  return result;
}

}  // namespace planescope::planes
