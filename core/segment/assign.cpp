// Sun et al. 2023, Sec. IV-C, last paragraph: points left over by the traversal go to planes.

#include <cmath>

#include "core/segment/cells.hpp"
#include "core/segment/state.hpp"

namespace planescope {
namespace {

void record(SegmentState& state, std::uint32_t i, std::int32_t plane, double distance) {
  state.log({.type = plane >= 0 ? EventType::assign : EventType::drop,
             .plane = plane,
             .point = state.input_index(i),
             .value = static_cast<float>(distance)});
  if (plane >= 0) ++state.counts.assigned;
  state.plane_of[i] = plane;
}

/// As written: the first plane of the list within the distance; the fit is not touched.
void assign_to_first(SegmentState& state, std::span<const std::uint32_t> leftovers) {
  for (const std::uint32_t i : leftovers) {
    const Vec3d p = state.octree.points[i].cast<double>();
    std::int32_t chosen = -1;
    double least = -1;  // of the planes looked at: what the trace shows for a point not assigned
    for (std::size_t k = 0; k < state.planes.size() && chosen < 0; ++k) {
      if (!state.planes[k].alive) continue;
      const double distance = std::abs(state.planes[k].fit.distance_m(p));
      if (least < 0 || distance < least) least = distance;
      if (distance <= state.options.leftover_distance_m) {
        chosen = static_cast<std::int32_t>(k);
        least = distance;
      }
    }
    record(state, i, chosen, least);
  }
}

/// R1: the nearest plane within tau among those with points in the neighbouring 10 cm cells; one of
/// the other label must be nearer by 1.5 sigma.
void assign_to_nearest(SegmentState& state, std::span<const std::uint32_t> leftovers) {
  const CellGrid grid = make_cell_grid(state.octree);
  const CellPlanes near = planes_near_cells(grid, state.plane_of, state.planes.size());
  for (const std::uint32_t i : leftovers) {
    const NearestPlane nearest = nearest_plane(state, near.near(grid.cell_of[i]), i);
    record(state, i, nearest.plane, nearest.distance_m);
  }
}

}  // namespace

NearestPlane nearest_plane(const SegmentState& state,
                           std::span<const std::int32_t> planes,
                           std::uint32_t i) {
  const Vec3d p = state.octree.points[i].cast<double>();
  const double range = state.range(p);
  const double tau = state.noise.tau(range);
  const double penalty = state.noise.other_label_penalty(range);
  NearestPlane best;
  double least = -1;
  for (const std::int32_t k : planes) {
    const GrowingPlane& plane = state.planes[k];
    if (!plane.alive) continue;
    const double distance = std::abs(plane.fit.distance_m(p));
    if (distance > tau) continue;
    const double cost = distance + (has_label(state, i, plane.label) ? 0 : penalty);
    if (least < 0 || cost < least) {
      least = cost;
      best = {k, distance};
    }
  }
  return best;
}

void give_up_plane(SegmentState& state, std::int32_t plane, std::span<const std::uint32_t> points) {
  state.planes[plane].alive = false;
  for (const std::uint32_t i : points) {
    state.plane_of[i] = -1;
    state.leftovers.push_back(i);
  }
}

void assign_leftovers(SegmentState& state, std::size_t first) {
  state.counts.leftovers = static_cast<std::uint32_t>(state.leftovers.size());
  const auto leftovers = std::span(state.leftovers).subspan(first);
  if (state.options.leftover_rule == LeftoverRule::nearest)
    assign_to_nearest(state, leftovers);
  else
    assign_to_first(state, leftovers);
}

}  // namespace planescope
