// The option split_disconnected: coplanar regions that do not touch become planes of their own,
// which is what a foothold planner needs. Not in the paper.

#include "core/segment/split.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/segment/state.hpp"

namespace planescope {
namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

Moments moments_of(const SegmentState& state, std::span<const std::uint32_t> points) {
  Moments moments;
  for (const std::uint32_t i : points) state.octree.add_point(moments, i);
  return moments;
}

/// Part 0 keeps the plane, the others found their own.
void split_off_parts(SegmentState& state, const CellGrid& grid, std::int32_t plane) {
  const PlaneParts parts = connected_parts(grid, state.plane_of, plane);
  if (parts.count < 2) return;
  std::vector<std::vector<std::uint32_t>> points(parts.count);
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
    if (state.plane_of[i] == plane) points[parts.of_cell[grid.cell_of[i]]].push_back(i);
  for (std::int32_t p = 1; p < parts.count; ++p) {
    GrowingPlane part;
    part.label = state.planes[plane].label;
    part.moments = moments_of(state, points[p]);
    part.fit = fit_plane(part.moments);
    const auto number = static_cast<std::int32_t>(state.planes.size());
    state.log({.type = EventType::found,
               .refinement = kSplit,
               .label = part.label,
               .plane = number,
               .other = plane});
    state.planes.push_back(part);
    for (const std::uint32_t i : points[p]) state.plane_of[i] = number;
  }
}

}  // namespace

CellGrid make_split_grid(const Octree& octree, const SegmentOptions& options) {
  const double leaf = octree.cube.edge_m / std::pow(2.0, octree.cube.max_depth);
  const long levels = std::lround(std::log2(options.split_cell_m / leaf));
  return make_cell_grid(octree, static_cast<int>(std::max(0l, levels)));
}

PlaneParts connected_parts(const CellGrid& grid,
                           std::span<const std::int32_t> plane_of,
                           std::int32_t plane) {
  // Union of touching cells that hold points of this plane.
  std::vector<std::uint8_t> holds(grid.size(), 0);
  for (std::size_t i = 0; i < plane_of.size(); ++i)
    if (plane_of[i] == plane) holds[grid.cell_of[i]] = 1;
  std::vector<std::uint32_t> parent(grid.size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (std::uint32_t c = 0; c < grid.size(); ++c)
    for (std::uint32_t k = grid.neighbour_first[c]; holds[c] && k < grid.neighbour_first[c + 1];
         ++k)
      if (holds[grid.neighbours[k]]) {
        const std::uint32_t a = root_of(parent, c), b = root_of(parent, grid.neighbours[k]);
        parent[std::max(a, b)] = std::min(a, b);
      }
  PlaneParts parts;
  parts.of_cell.assign(grid.size(), -1);
  for (std::uint32_t c = 0; c < grid.size(); ++c) {
    if (!holds[c]) continue;
    const std::uint32_t root = root_of(parent, c);  // the first cell of its part
    parts.of_cell[c] = root == c ? parts.count++ : parts.of_cell[root];
  }
  return parts;
}

void split_disconnected_planes(SegmentState& state) {
  const CellGrid grid = make_split_grid(state.octree, state.options);
  const auto founded = static_cast<std::int32_t>(state.planes.size());
  for (std::int32_t plane = 0; plane < founded; ++plane)
    if (state.planes[plane].alive) split_off_parts(state, grid, plane);
  if (state.planes.size() == static_cast<std::size_t>(founded)) return;

  const PlanePoints members = points_by_plane(state);
  for (std::int32_t plane = 0; plane < founded; ++plane) {
    if (!state.planes[plane].alive) continue;
    const Moments moments = moments_of(state, members.of(plane));
    state.log_refit(plane, moments, kSplit);
    state.planes[plane].moments = moments;
    state.planes[plane].fit = fit_plane(moments);
  }
  // A part too small to be a candidate is none.
  const auto least = static_cast<std::size_t>(std::max(3, state.options.theta_n_in));
  for (std::size_t k = 0; k < state.planes.size(); ++k) {
    const auto plane = static_cast<std::int32_t>(k);
    const auto points = members.of(plane);
    if (points.empty() || points.size() >= least) continue;
    state.log({.type = EventType::leave, .refinement = kSplit, .plane = plane});
    state.planes[k].alive = false;
    for (const std::uint32_t i : points) {
      state.plane_of[i] = -1;
      state.leftovers.push_back(i);
    }
  }
}

}  // namespace planescope
