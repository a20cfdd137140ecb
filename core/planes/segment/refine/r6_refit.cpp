#include "core/planes/segment/refine/r6_refit.hpp"

#include <algorithm>
#include <cmath>

#include "core/planes/segment/choices.hpp"

namespace planescope::planes::r6_refit {

void run(SegmentState& state, const Options& options) {
  if (!options.on) return;
  const Neighbourhood around(state);
  std::vector<Moments> sure(state.planes.size()), all(state.planes.size());
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i) {
    const std::int32_t own = state.plane_of[i];
    if (own < 0) continue;
    const Vec3d p = state.point(i);
    const double tau = state.reach(i).limit_m;
    state.octree.add_point(all[own], i);
    const auto near = around.near(i);
    const bool shared = std::any_of(near.begin(), near.end(), [&](std::int32_t k) {
      return k != own && state.planes[k].alive &&
             std::abs(state.planes[k].fit.distance_m(p)) <= tau;
    });
    if (!shared) state.octree.add_point(sure[own], i);
  }
  const auto uncertainty = [&](const Moments& moments) {
    return state.sigma_ang(fit_plane(moments));
  };
  for (std::size_t k = 0; k < state.planes.size(); ++k) {
    const GrowingPlane& plane = state.planes[k];
    const double enough =
        std::max<double>(options.sure_points, options.sure_share * plane.moments.count);
    if (!plane.alive || sure[k].count < enough) continue;
    const bool is_strip = uncertainty(sure[k]) > options.max_loss * uncertainty(all[k]);
    const auto number = static_cast<std::int32_t>(k);
    log_refine(state, options, number);
    fit_again(state, number, is_strip ? all[k] : sure[k]);
  }
}

}  // namespace planescope::planes::r6_refit
