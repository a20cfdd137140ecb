#include "core/planes/foot/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/planes/outline/outline_pixels.hpp"

namespace planescope::planes {
namespace {

/// The plane of each pixel, 0 none.
std::vector<std::int32_t> planes_by_pixel(const Frame& frame, const FrameResult& result) {
  std::vector<std::int32_t> plane_of(frame.depth.data.size(), 0);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    plane_of[result.cloud.source[i]] = result.plane_of[i];
  return plane_of;
}

/// The share of pixels within the outline that are the plane's; nothing where there are none.
std::optional<double> support_by_pixels(const std::vector<PixelRun>& within,
                                        const std::vector<std::int32_t>& plane_of,
                                        int width,
                                        std::int32_t id) {
  double all = 0, seen = 0;
  for (const PixelRun& run : within) {
    const std::int32_t* row = plane_of.data() + static_cast<std::size_t>(run.y) * width;
    all += run.x1 - run.x0;
    seen += static_cast<double>(std::count(row + run.x0, row + run.x1, id));
  }
  return all > 0 ? std::optional(seen / all) : std::nullopt;
}

double support_by_places(const Places& places, const Outline& outline) {
  double within_m2 = outline.area_m2;
  for (const Outline::Part& part : outline.parts)
    for (const PolygonRing& hole : part.unknown) within_m2 -= polygon_area(hole);
  return within_m2 > 0 ? std::min(1.0, places.covered_m2() / within_m2) : 0;
}

}  // namespace

std::vector<Surface> surfaces_of(const Frame& frame,
                                 const FrameResult& result,
                                 const std::vector<Outline>& outlines,
                                 const std::vector<Places>& places) {
  constexpr double kCircle_m = 0.005;  // how near to the best place is near enough
  constexpr double kMostSteps = 0.95;
  std::vector<std::int32_t> plane_of;
  if (!frame.is_cloud()) plane_of = planes_by_pixel(frame, result);
  const Pose T_sensor_world = result.cloud.T_world_sensor.inverse();
  std::vector<Surface> surfaces(outlines.size());
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const Outline& outline = outlines[k];
    Surface& surface = surfaces[k];
    const double level = std::min(1.0, std::abs(result.segmentation.planes[k].fit.normal.z()));
    surface.slope_deg =
        result.gravity.known() ? std::acos(level) * 180 / std::numbers::pi : std::nan("");
    surface.rough_rms_m = places[k].rough_rms_m();
    surface.rough_step_m = places[k].step_m(kMostSteps);
    std::optional<double> support;
    if (!frame.is_cloud())
      if (const auto within = pixels_within(outline, frame.intrinsics, T_sensor_world, true))
        support = support_by_pixels(*within, plane_of, frame.intrinsics.width,
                                    static_cast<std::int32_t>(k) + 1);
    surface.support = support ? *support : support_by_places(places[k], outline);
    const Circle circle = largest_circle(polygons_of(outline), kCircle_m);
    surface.clearance_m = circle.radius_m;
    surface.best_place = outline.world(circle.centre);
  }
  return surfaces;
}

}  // namespace planescope::planes
