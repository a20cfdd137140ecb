#include "core/planes/segment/refine/r2_explain_away.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/planes/segment/choices.hpp"

namespace planescope::planes {
namespace r2_explain_away {
namespace {

bool is_larger(const SegmentState& state, std::int32_t a, std::int32_t b) {
  const double na = state.planes[a].moments.count, nb = state.planes[b].moments.count;
  return na > nb || (na == nb && a < b);
}

bool contradicts_its_label(const GrowingPlane& plane, double beyond_deg) {
  const double z = std::abs(plane.fit.normal.z());
  const auto cosine = [](double deg) { return std::cos(deg * std::numbers::pi / 180); };
  return plane.label == Label::h ? z < cosine(45 + beyond_deg) : z > cosine(45 - beyond_deg);
}

void drop(SegmentState& state, std::int32_t plane, std::span<const std::uint32_t> points) {
  log_refine(state, state.options.r2_explain_away, plane);
  drop_plane(state, plane, points);
}

}  // namespace

bool is_wider_than_noise(const PlaneFit& fit, double sigma_m, const Options& options) {
  return std::sqrt(fit.eigenvalues[1] / fit.count) >= options.width_sigmas * sigma_m;
}

bool is_dense(const PlaneFit& fit, double typical_area_per_point, const Options& options) {
  return options.density_share * area_per_point(fit) <= typical_area_per_point;
}

void run(SegmentState& state, const Options& options) {
  if (!options.on) return;
  const double typical_area = typical_area_per_point(state);
  const Neighbourhood around(state);
  const PlanePoints members = points_by_plane(state);
  std::vector<std::int32_t> smallest_first(state.planes.size());
  std::iota(smallest_first.begin(), smallest_first.end(), 0);
  std::sort(smallest_first.begin(), smallest_first.end(),
            [&](auto a, auto b) { return is_larger(state, b, a); });
  for (const std::int32_t plane : smallest_first) {
    if (!state.planes[plane].alive) continue;
    const auto points = members.of(plane);
    if (!evidence_for(state, plane, points, around, typical_area).stays())
      drop(state, plane, points);
  }
}

void drop_emptied_planes(SegmentState& state) {
  const Options& options = state.options.r2_explain_away;
  if (!options.on) return;
  const std::size_t first = state.leftovers.size();
  const PlanePoints members = points_by_plane(state);
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    const auto points = members.of(k);
    if (state.planes[k].alive &&
        static_cast<double>(points.size()) < options.kept_share * state.planes[k].moments.count)
      drop(state, k, points);
  }
  if (state.leftovers.size() > first) assign_leftovers(state, first);
}

}  // namespace r2_explain_away

Evidence evidence_for(const SegmentState& state,
                      std::int32_t plane,
                      std::span<const std::uint32_t> points,
                      const Neighbourhood& around,
                      double typical_area) {
  using namespace r2_explain_away;
  const Options& options = state.options.r2_explain_away;
  const GrowingPlane& own = state.planes[plane];
  Evidence evidence;
  evidence.points = points.size();
  for (const std::uint32_t i : points) {
    const Vec3d p = state.point(i);
    const double tau = state.reach(i).limit_m;
    const auto explains = [&](std::int32_t k) {
      const GrowingPlane& other = state.planes[k];
      const double reach = other.label == own.label ? tau : options.other_label_tau * tau;
      return other.alive && is_larger(state, k, plane) &&
             std::abs(other.fit.distance_m(p)) <= reach;
    };
    const auto near = around.near(i);
    if (std::none_of(near.begin(), near.end(), explains)) ++evidence.unexplained;
  }
  evidence.unexplained_enough =
      static_cast<double>(evidence.unexplained) >=
      std::max<double>(options.unexplained_points,
                       options.unexplained_share * static_cast<double>(points.size()));
  evidence.wide = is_wider_than_noise(own.fit, state.sigma(own.fit), options);
  evidence.dense = is_dense(own.fit, typical_area, options);
  evidence.contradicts =
      state.options.use_labels && contradicts_its_label(own, options.contradiction_deg);
  return evidence;
}

}  // namespace planescope::planes
