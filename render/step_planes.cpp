// The planes of the trace as they stand at a step.

#include <algorithm>
#include <string>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"
#include "render/step_parts.hpp"
#include "render/theme.hpp"

namespace planescope::render {
namespace {

constexpr double kLeastShareNamed = 0.008;  // of the voxels: smaller planes get no arrow and name

/// Which voxels each plane holds at this moment.
std::vector<std::vector<Vec3f>> points_by_plane(const debug::Run& run, const StepState& state) {
  const std::vector<Vec3f>& points = run.subject->prepared.voxels.points;
  std::vector<std::vector<Vec3f>> members(static_cast<std::size_t>(run.timeline.plane_count()));
  for (std::size_t v = 0; v < points.size(); ++v)
    if (state.plane_of[v] >= 0)
      members[static_cast<std::size_t>(state.plane_of[v])].push_back(points[v]);
  return members;
}

}  // namespace

void add_planes(const debug::Run& run,
                const StepLook& look,
                const StepState& state,
                DrawList& list) {
  const std::vector<Vec3f>& points = run.subject->prepared.voxels.points;
  const float extent_m = robust_bounds(points).diagonal();
  const float arrow_m = std::clamp(0.05F * extent_m, 0.06F, 1.0F);
  const Rgba ink = theme_colors(look.theme).ink;
  const Rgba selected_color = mark_colors(look.theme).selected;
  const auto members = points_by_plane(run, state);
  for (std::int32_t plane = 0; plane < run.timeline.plane_count(); ++plane) {
    const planes::PlaneChange* change = run.timeline.plane_at(plane, look.step);
    if (change == nullptr || !change->alive) continue;
    const auto& own = members[static_cast<std::size_t>(plane)];
    DrawPolygon polygon;
    polygon.corners = outline_on_plane(change->fit, own);
    if (polygon.corners.size() < 3) continue;
    const bool selected = plane == look.plane;
    const bool current = plane == state.plane;
    const Rgba color = plane_color(plane + 1);
    const Rgba strong = selected ? selected_color : mix(color, ink, 0.35);
    polygon.fill = with_alpha(color, 45);
    polygon.outline = with_alpha(strong, 235);
    polygon.outline_px = selected || current ? 3.5F : 2.0F;
    polygon.id = pick_id(Picked::Kind::plane, plane);
    list.polygons.push_back(std::move(polygon));

    const bool large =
        static_cast<double>(own.size()) >= kLeastShareNamed * static_cast<double>(points.size());
    if (!large && !selected && !current) continue;
    const Vec3f from = change->fit.centroid.cast<float>();
    // Towards the eye of a reader: up, or to the sensor's side.
    Vec3f normal = change->fit.normal.cast<float>();
    const Vec3f to_sensor = run.subject->prepared.sensor().cast<float>() - from;
    if (run.timeline.label_of_plane(plane) == Label::h ? normal.z() < 0 : normal.dot(to_sensor) < 0)
      normal = -normal;
    list.arrows.push_back({from, from + arrow_m * normal, strong, selected ? 3.5F : 2.5F});
    list.labels.push_back({from + 1.35F * arrow_m * normal, debug::plane_name(plane),
                           selected ? selected_color : ink, selected ? 19.0F : 16.0F, true});
  }
}

}  // namespace planescope::render
