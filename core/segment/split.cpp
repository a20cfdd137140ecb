// The option split_disconnected: coplanar regions that do not touch become planes of their own,
// which is what a foothold planner needs. Not in the paper.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/segment/cells.hpp"
#include "core/segment/state.hpp"

namespace planescope {
namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

void split_disconnected_planes(SegmentState& state) {
  const double leaf = state.octree.cube.edge_m / std::pow(2.0, state.octree.cube.max_depth);
  const int levels =
      std::max(0, static_cast<int>(std::lround(std::log2(state.options.split_cell_m / leaf))));
  const CellGrid grid = make_cell_grid(state.octree, levels);
  const std::size_t founded = state.planes.size();
  for (std::size_t plane = 0; plane < founded; ++plane) {
    if (!state.planes[plane].alive) continue;
    // Union of touching cells that hold points of this plane.
    std::vector<std::uint8_t> holds(grid.size(), 0);
    for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
      if (state.plane_of[i] == static_cast<std::int32_t>(plane)) holds[grid.cell_of[i]] = 1;
    std::vector<std::uint32_t> parent(grid.size());
    std::iota(parent.begin(), parent.end(), 0u);
    for (std::uint32_t c = 0; c < grid.size(); ++c)
      for (std::uint32_t k = grid.neighbour_first[c]; holds[c] && k < grid.neighbour_first[c + 1];
           ++k)
        if (holds[grid.neighbours[k]]) {
          const std::uint32_t a = root_of(parent, c), b = root_of(parent, grid.neighbours[k]);
          parent[std::max(a, b)] = std::min(a, b);
        }
    // The component of the first cell keeps the plane, the others found their own.
    std::vector<std::int32_t> plane_of_root(grid.size(), -1);
    bool first = true;
    for (std::uint32_t c = 0; c < grid.size(); ++c) {
      if (!holds[c] || root_of(parent, c) != c) continue;
      plane_of_root[c] =
          first ? static_cast<std::int32_t>(plane) : static_cast<std::int32_t>(state.planes.size());
      if (!first) {
        GrowingPlane part;
        part.label = state.planes[plane].label;
        state.planes.push_back(part);
        state.log({.type = EventType::found,
                   .plane = plane_of_root[c],
                   .other = static_cast<std::int32_t>(plane)});
      }
      first = false;
    }
    for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
      if (state.plane_of[i] == static_cast<std::int32_t>(plane))
        state.plane_of[i] = plane_of_root[root_of(parent, grid.cell_of[i])];
  }
  if (state.planes.size() == founded) return;
  for (GrowingPlane& plane : state.planes) plane.moments = {};
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
    if (state.plane_of[i] >= 0)
      state.planes[state.plane_of[i]].moments.add(state.octree.points[i].cast<double>());
  for (GrowingPlane& plane : state.planes)
    if (plane.alive) plane.fit = fit_plane(plane.moments);
  // A part too small to be a candidate is none.
  for (std::int32_t& plane : state.plane_of)
    if (plane >= 0 && state.planes[plane].moments.count < std::max(3, state.options.theta_n_in))
      plane = -1;
}

}  // namespace planescope
