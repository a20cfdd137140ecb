// Refinements after the traversal: R2, R5, R6 and the split of disconnected planes. Not in the
// paper; docs/method.md says what each of them mends and what it measures.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/segment/cells.hpp"
#include "core/segment/state.hpp"

namespace planescope {
namespace {

/// Are all its points of one class, and the plane clearly of the other? Eq. (1)'s 45 degrees, and
/// 15 beyond them.
bool contradicts_its_label(const GrowingPlane& plane) {
  constexpr double kCos30 = 0.866025403784438647, kCos60 = 0.5;
  const double z = std::abs(plane.fit.normal.z());
  return plane.label == Label::h ? z < kCos60 : z > kCos30;
}

void drop(SegmentState& state, std::int32_t plane, std::span<const std::uint32_t> points) {
  state.log({.type = EventType::refine, .refinement = 2, .plane = plane});
  give_up_plane(state, plane, points);
}

bool larger(const SegmentState& state, std::int32_t a, std::int32_t b) {
  const double na = state.planes[a].moments.count, nb = state.planes[b].moments.count;
  return na > nb || (na == nb && a < b);
}

}  // namespace

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

void prune_explained_planes(SegmentState& state) {
  // R2: smallest first, a plane whose points nearly all lie on larger neighbours is an artefact of
  // cells that straddle an edge, and one no wider than the noise, or far thinner than the others,
  // or that its own label contradicts, is noise. Its points are left over again. On a neighbour of
  // the other label they must lie closer: all of a small box's top is near its side.
  constexpr double kOtherLabelShare = 0.5;
  const double typical_area = typical_area_per_point(state);
  const CellGrid grid = make_cell_grid(state.octree);
  const CellPlanes near = planes_near_cells(grid, state.plane_of, state.planes.size());
  const PlanePoints members = points_by_plane(state);
  std::vector<std::int32_t> order(state.planes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return larger(state, b, a); });
  for (const std::int32_t plane : order) {
    if (!state.planes[plane].alive) continue;
    const Label label = state.planes[plane].label;
    const auto points = members.of(plane);
    std::size_t unexplained = 0;
    for (const std::uint32_t i : points) {
      const Vec3d p = state.octree.points[i].cast<double>();
      const double tau = state.tau(p);
      const auto explains = [&](std::int32_t other) {
        const GrowingPlane& larger_plane = state.planes[other];
        const double reach = larger_plane.label == label ? tau : kOtherLabelShare * tau;
        return larger_plane.alive && larger(state, other, plane) &&
               std::abs(larger_plane.fit.distance_m(p)) <= reach;
      };
      const auto candidates = near.near(grid.cell_of[i]);
      if (std::none_of(candidates.begin(), candidates.end(), explains)) ++unexplained;
    }
    const PlaneFit& fit = state.planes[plane].fit;
    if (static_cast<double>(unexplained) >=
            std::max(8.0, 0.25 * static_cast<double>(points.size())) &&
        is_wider_than_noise(fit, state.noise.sigma(state.range(fit.centroid))) &&
        is_dense(fit, typical_area) &&
        !(state.options.use_labels && contradicts_its_label(state.planes[plane])))
      continue;
    drop(state, plane, points);
  }
}

void refit_planes(SegmentState& state) {
  // R6: points within tau of a second plane pull a fit towards the edge; leave them out.
  constexpr double kMinPoints = 10, kMostLoss = 1.2;
  const CellGrid grid = make_cell_grid(state.octree);
  const CellPlanes near = planes_near_cells(grid, state.plane_of, state.planes.size());
  std::vector<Moments> sure(state.planes.size()), all(state.planes.size());
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i) {
    const std::int32_t own = state.plane_of[i];
    if (own < 0) continue;
    const Vec3d p = state.octree.points[i].cast<double>();
    const double tau = state.tau(p);
    state.octree.add_point(all[own], i);
    const auto candidates = near.near(grid.cell_of[i]);
    const bool shared = std::any_of(candidates.begin(), candidates.end(), [&](std::int32_t k) {
      return k != own && state.planes[k].alive &&
             std::abs(state.planes[k].fit.distance_m(p)) <= tau;
    });
    if (!shared) state.octree.add_point(sure[own], i);
  }
  for (std::size_t k = 0; k < state.planes.size(); ++k) {
    GrowingPlane& plane = state.planes[k];
    if (!plane.alive || sure[k].count < std::max(kMinPoints, 0.3 * plane.moments.count)) continue;
    // Of a low riser only a strip is left, whose normal is known less well than with all points.
    const auto uncertainty = [&](const Moments& moments) {
      const PlaneFit fit = fit_plane(moments);
      return normal_uncertainty(fit, state.noise.sigma(state.range(fit.centroid)));
    };
    const bool strip = uncertainty(sure[k]) > kMostLoss * uncertainty(all[k]);
    const Moments& chosen = strip ? all[k] : sure[k];
    state.log_refit(static_cast<std::int32_t>(k), chosen, 6);
    plane.moments = chosen;
    plane.fit = fit_plane(plane.moments);
    plane.sigma_ang = uncertainty(plane.moments);
  }
}

void reassign_shared_points(SegmentState& state) {
  // R5: where planes meet, each point goes to the nearest of them.
  const CellGrid grid = make_cell_grid(state.octree);
  const CellPlanes near = planes_near_cells(grid, state.plane_of, state.planes.size());
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i) {
    const auto candidates = near.near(grid.cell_of[i]);
    if (state.plane_of[i] < 0 || candidates.size() < 2) continue;
    const NearestPlane nearest = nearest_plane(state, candidates, i);
    if (nearest.plane < 0 || nearest.plane == state.plane_of[i]) continue;
    state.log({.type = EventType::refine,
               .refinement = 5,
               .plane = state.plane_of[i],
               .other = nearest.plane,
               .point = state.input_index(i),
               .value = static_cast<float>(nearest.distance_m)});
    state.plane_of[i] = nearest.plane;
  }
}

void drop_emptied_planes(SegmentState& state) {
  // R2 again: a plane that lost most of its points to its neighbours was made of them.
  constexpr double kLeastKept = 0.5;
  const std::size_t first = state.leftovers.size();
  const PlanePoints members = points_by_plane(state);
  for (std::size_t k = 0; k < state.planes.size(); ++k) {
    const auto points = members.of(static_cast<std::int32_t>(k));
    if (state.planes[k].alive &&
        static_cast<double>(points.size()) < kLeastKept * state.planes[k].moments.count)
      drop(state, static_cast<std::int32_t>(k), points);
  }
  if (state.leftovers.size() > first) assign_leftovers(state, first);
}

}  // namespace planescope
