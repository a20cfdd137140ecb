// The planes of a frame: points, outlines, normals, ids.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "render/scene_parts.hpp"
#include "render/scenes.hpp"

namespace planescope::render {
namespace {

constexpr double kLeastShareNamed = 0.008;  // of the voxels: smaller planes get no arrow and id

bool is_named(const planes::PlaneRegion& plane, const planes::FrameResult& result) {
  return plane.points >= kLeastShareNamed * static_cast<double>(result.voxels.points.size());
}

/// Some files carry a colour field that was never filled: one value for all points.
bool has_colors(std::span<const std::uint8_t> rgb) {
  for (std::size_t i = 3; i < rgb.size(); ++i)
    if (rgb[i] != rgb[i % 3]) return true;
  return false;
}

/// Convex outline of the voxels of each plane, on the plane.
std::vector<std::vector<Vec3f>> outlines(const planes::FrameResult& result) {
  const auto& planes = result.segmentation.planes;
  std::vector<std::vector<Vec3f>> members(planes.size());
  for (std::size_t i = 0; i < result.voxels.points.size(); ++i) {
    const std::int32_t id = result.segmentation.plane_of[i];
    if (id > 0) members[static_cast<std::size_t>(id - 1)].push_back(result.voxels.points[i]);
  }
  std::vector<std::vector<Vec3f>> corners;
  for (std::size_t k = 0; k < planes.size(); ++k)
    corners.push_back(outline_on_plane(planes[k].fit, members[k]));
  return corners;
}

void add_plane_shapes(const planes::FrameResult& result,
                      std::span<const int> color_of_plane,
                      DrawList& list) {
  const float extent_m = robust_bounds(result.voxels.points).diagonal();
  const float arrow_m = std::clamp(0.05F * extent_m, 0.06F, 1.0F);
  const auto corners = outlines(result);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (corners[k].size() < 3) continue;
    const planes::PlaneRegion& plane = result.segmentation.planes[k];
    const Rgba color = color_of(plane.id, color_of_plane);
    const Rgba dark = mix(color, kSceneText, 0.45);
    DrawPolygon polygon;
    polygon.corners = corners[k];
    polygon.fill = with_alpha(color, 50);
    polygon.outline = with_alpha(dark, 230);
    polygon.id = static_cast<std::uint32_t>(plane.id);
    list.polygons.push_back(std::move(polygon));

    if (!is_named(plane, result)) continue;
    const Vec3f from = plane.fit.centroid.cast<float>();
    const Vec3f normal = plane.fit.normal.cast<float>();
    list.arrows.push_back({from, from + arrow_m * normal, dark, 2.5F});
    list.labels.push_back(
        {from + 1.35F * arrow_m * normal, std::to_string(plane.id), kSceneText, 19, true});
  }
}

}  // namespace

DrawList scene_planes(const planes::FrameResult& result, std::span<const int> color_of_plane) {
  using Mark = LegendEntry::Mark;
  DrawList list;
  DrawPoints points = voxel_points(result.voxels);
  std::size_t in_planes = 0;
  for (const std::int32_t id : result.segmentation.plane_of) {
    points.colors.push_back(id > 0 ? color_of(id, color_of_plane) : kSceneFaded);
    points.ids.push_back(id > 0 ? static_cast<std::uint32_t>(id) : 0);
    in_planes += id > 0;
  }
  const std::size_t n = points.positions.size();
  list.points.push_back(std::move(points));
  add_plane_shapes(result, color_of_plane, list);
  add_plane_legend(result, color_of_plane, list);
  if (in_planes < n)
    list.legend.push_back(
        {Mark::dot, kSceneFaded, "in no plane  " + std::to_string(n - in_planes)});
  add_gravity(result, list);
  const std::size_t planes = result.segmentation.planes.size();
  list.title = "Final planes";
  list.subtitle = std::to_string(planes) + (planes == 1 ? " plane holds " : " planes hold ") +
                  percent(in_planes, n) + " of " + std::to_string(n) + " voxels";
  return list;
}

DrawList scene_overlay(const Frame& frame,
                       const planes::FrameResult& result,
                       std::span<const int> color_of_plane) {
  DrawList list;
  DrawPoints points;
  points.size_m = 0.012F;
  points.min_px = 2.5F;
  const bool colored = frame.cloud && has_colors(frame.cloud->rgb);
  for (std::size_t i = 0; i < result.cloud.points.size(); ++i) {
    if (!result.cloud.kept[i]) continue;
    points.positions.push_back(result.cloud.points[i]);
    Rgba base{160, 163, 168, 255};
    if (colored) {
      const std::uint8_t* rgb =
          &frame.cloud->rgb[3 * static_cast<std::size_t>(result.cloud.source[i])];
      base = {rgb[0], rgb[1], rgb[2], 255};
    }
    const std::int32_t id = result.plane_of[i];
    points.colors.push_back(id > 0 ? mix(base, color_of(id, color_of_plane), 0.6) : base);
  }
  list.title = "Planes over the cloud";
  list.subtitle = std::to_string(points.positions.size()) + " points";
  list.points.push_back(std::move(points));
  for (const planes::PlaneRegion& plane : result.segmentation.planes)
    if (is_named(plane, result))
      list.labels.push_back(
          {plane.fit.centroid.cast<float>(), std::to_string(plane.id), kSceneText, 19, true});
  add_gravity(result, list);
  add_plane_legend(result, color_of_plane, list);
  return list;
}

}  // namespace planescope::render
