#include "render/step_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"
#include "render/step_parts.hpp"

namespace planescope::render {
namespace {

constexpr int kKindShift = 30;
constexpr std::uint32_t kIndexMask = (1u << kKindShift) - 1;

/// One voxel made large, so that it is found among its neighbours.
void add_voxel(const debug::Run& run,
               std::int32_t voxel,
               Rgba color,
               const std::string& text,
               DrawList& list) {
  if (voxel < 0) return;
  const Vec3f at = run.subject->prepared.voxels.points[static_cast<std::size_t>(voxel)];
  DrawPoints dot = voxel_points(planes::VoxelCloud{});
  dot.positions = {at};
  dot.colors = {color};
  dot.ids = {pick_id(Picked::Kind::voxel, voxel)};
  dot.min_px = 14;
  list.points.push_back(std::move(dot));
  const auto above = static_cast<float>(1.5 * run.subject->prepared.voxels.size_m + 0.01);
  list.labels.push_back({at + Vec3f(0, 0, above), text, color, 15, true});
}

}  // namespace

std::uint32_t pick_id(Picked::Kind kind, std::int32_t index) {
  return static_cast<std::uint32_t>(kind) << kKindShift | static_cast<std::uint32_t>(index);
}

Picked picked(std::uint32_t id) {
  const auto kind = static_cast<Picked::Kind>(id >> kKindShift);
  if (kind == Picked::Kind::nothing) return {};
  return {kind, static_cast<std::int32_t>(id & kIndexMask)};
}

DrawList scene_step(const debug::Run& run, const StepLook& look) {
  const StepState state = step_state(run, look.step);
  const MarkColors marks = mark_colors(look.theme);
  DrawList list;
  list.pick_points_first = true;
  DrawPoints points = voxel_points(run.subject->prepared.voxels);
  points.colors = voxel_colors(run, look, state);
  points.ids.resize(points.positions.size());
  std::iota(points.ids.begin(), points.ids.end(), pick_id(Picked::Kind::voxel, 0));
  points.max_px = 120;  // surfaces stay closed close by
  list.points.push_back(std::move(points));
  add_node_boxes(run, look, state, list);
  if (look.show_planes) add_planes(run, look, state, list);
  const auto name = [](std::int32_t voxel) { return "voxel " + std::to_string(voxel); };
  if (state.voxel != look.voxel)
    add_voxel(run, state.voxel, marks.current, name(state.voxel), list);
  add_voxel(run, look.voxel, marks.selected, name(look.voxel), list);
  add_step_legend(run, look, state, list);
  return list;
}

Camera camera_on_node(const debug::Run& run, std::int32_t node, const Camera& camera) {
  const planes::Octree& octree = run.octree();
  const DrawBox box = points_box(octree, octree.nodes[static_cast<std::size_t>(node)],
                                 run.subject->prepared.voxels.size_m);
  const Vec3d middle = ((box.min + box.max) / 2).cast<double>();
  const double radius_m = std::max({0.5 * (box.max - box.min).cast<double>().norm(),
                                    4 * run.subject->prepared.voxels.size_m, 0.02});
  constexpr double kRoom = 2;  // the node's surroundings say where it is
  const double half_view = camera.fov_y_deg * std::numbers::pi / 360;
  const double distance_m = kRoom * radius_m / std::sin(half_view);
  Vec3d back = camera.eye - camera.target;
  if (back.norm() < 1e-9) back = Vec3d(-1, 0, 1);
  Camera moved = camera;
  moved.target = middle;
  moved.eye = middle + distance_m * back.normalized();
  moved.ortho_height_m = 2 * kRoom * radius_m;
  moved.near_m = std::max(0.005, 0.02 * distance_m);
  moved.far_m = std::max(camera.far_m, 20 * distance_m);
  return moved;
}

}  // namespace planescope::render
