#include "core/planes/foot/footholds.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace planescope::planes {
namespace {

std::string reasons_against(Label label,
                            const Surface& surface,
                            const FootSpace& space,
                            const FootOptions& limits) {
  std::vector<std::string> reasons;
  if (label == Label::v)
    reasons.emplace_back("upright, v");
  else if (std::isnan(surface.slope_deg))
    reasons.emplace_back("gravity is not known, and so no slope");
  else if (surface.slope_deg > limits.max_slope_deg)
    reasons.push_back(
        fmt::format("slope {:.1f} deg, limit {}", surface.slope_deg, limits.max_slope_deg));
  if (space.area.empty())
    reasons.emplace_back("no room for the foot");
  else if (space.area_m2 < limits.min_area_m2)
    reasons.push_back(fmt::format("room of {:.0f} cm2 for the foot's centre, limit {:g}",
                                  space.area_m2 * 1e4, limits.min_area_m2 * 1e4));
  if (surface.rough_rms_m > limits.max_rough_m)
    reasons.push_back(fmt::format("{:.3g} mm rough, limit {:g}", surface.rough_rms_m * 1e3,
                                  limits.max_rough_m * 1e3));
  if (surface.support < limits.min_support)
    reasons.push_back(fmt::format("{:.0f} % of it was measured, limit {:g}", surface.support * 100,
                                  limits.min_support * 100));
  return fmt::format("{}", fmt::join(reasons, "; "));
}

}  // namespace

std::vector<Foothold> footholds_of(const Frame& frame,
                                   const FrameResult& result,
                                   const std::vector<Outline>& outlines,
                                   double cell_m,
                                   const FootOptions& options) {
  const std::vector<Places> places = places_of(result, outlines, cell_m);
  const std::vector<Surface> surfaces = surfaces_of(frame, result, outlines, places);
  const std::vector<Certainty> certainties = certainties_of(result);
  std::vector<Foothold> footholds(outlines.size());
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    Foothold& foothold = footholds[k];
    foothold.surface = surfaces[k];
    foothold.certainty = certainties[k];
    const PlaneBasis& basis = outlines[k].basis;
    const Vec3d& axis = certainties[k].axes[0];
    foothold.cut = places[k].cut(Vec2d::Zero(), {basis.u.dot(axis), basis.v.dot(axis)});
    if (!(options.radius_m > 0)) continue;
    foothold.space = foot_space(outlines[k], places[k], options);
    foothold.why_not =
        reasons_against(result.segmentation.planes[k].label, surfaces[k], *foothold.space, options);
    foothold.steppable = foothold.why_not.empty();
  }
  return footholds;
}

}  // namespace planescope::planes
