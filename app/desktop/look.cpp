#include "app/desktop/look.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "app/desktop/debugger/plane_text.hpp"

namespace planescope::desktop {
namespace {

constexpr double kDeg = 0.017453292519943295;  // [rad]

template <typename T>
const T* item(const std::vector<T>& items, int index) {
  return index >= 0 && index < static_cast<int>(items.size())
             ? &items[static_cast<std::size_t>(index)]
             : nullptr;
}

/// What the tab that is open asks about.
std::span<const std::uint32_t> marked_pixels(const State& state) {
  const LabelView& view = state.view.label;
  const LabelResults& results = state.results.label;
  if (view.tab == "review" && results.review)
    if (const labels::Disagreement* about = item(results.review->items, view.review_item))
      return about->pixels;
  if (view.tab == "checks" && results.audit)
    if (const labels::Finding* about = item(results.audit->findings, view.finding))
      return about->pixels;
  return {};
}

}  // namespace

render::Camera preset_camera(const render::Camera& home, CameraPreset preset) {
  render::Camera camera = home;
  if (preset == CameraPreset::home) return camera;
  const double distance = (camera.eye - camera.target).norm();
  const Vec3d looks = camera.target - camera.eye;
  const Vec3d ahead = Vec3d(looks.x(), looks.y(), 0).norm() > 1e-9
                          ? Vec3d(looks.x(), looks.y(), 0).normalized()
                          : Vec3d(Vec3d::UnitX());
  switch (preset) {
    case CameraPreset::top:
      camera.eye = camera.target + distance * Vec3d::UnitZ();
      camera.up = ahead;
      break;
    case CameraPreset::side:
      camera.eye = camera.target + distance * ahead.cross(Vec3d::UnitZ());
      break;
    default:
      camera.eye = camera.target - distance * ahead;
  }
  return camera;
}

render::Camera camera_of(const State& state) {
  if (state.view.camera) return *state.view.camera;
  return state.run_view() ? state.run_view()->home : render::Camera{};
}

render::Camera orbited(const render::Camera& camera, double right_deg, double up_deg) {
  const Vec3d offset = camera.eye - camera.target;
  const double distance = offset.norm();
  double azimuth = std::atan2(offset.y(), offset.x());
  const double elevation = std::asin(std::clamp(offset.z() / distance, -1.0, 1.0));
  if (camera.up.z() < 0.5 && std::abs(offset.z()) > 0.999 * distance)  // from above: up tells
    azimuth = std::atan2(-camera.up.y(), -camera.up.x());
  // Just short of the pole, so that up stays up.
  const double tilted = std::clamp(elevation + up_deg * kDeg, -89.9 * kDeg, 89.9 * kDeg);
  const double turned = azimuth - right_deg * kDeg;
  render::Camera result = camera;
  result.up = Vec3d::UnitZ();
  result.eye =
      camera.target + distance * Vec3d(std::cos(tilted) * std::cos(turned),
                                       std::cos(tilted) * std::sin(turned), std::sin(tilted));
  return result;
}

render::Camera panned(const render::Camera& camera, double right, double up) {
  const Vec3d forward = (camera.target - camera.eye).normalized();
  const Vec3d sideways = forward.cross(camera.up).normalized();
  const Vec3d upwards = sideways.cross(forward);
  const double height =
      2 * (camera.target - camera.eye).norm() * std::tan(camera.fov_y_deg * kDeg / 2);
  const Vec3d by = height * (right * sideways + up * upwards);
  render::Camera result = camera;
  result.eye += by;
  result.target += by;
  return result;
}

render::Camera zoomed(const render::Camera& camera, double factor) {
  render::Camera result = camera;
  const Vec3d offset = camera.eye - camera.target;
  const double distance = std::clamp(offset.norm() / std::clamp(factor, 0.01, 100.0), 0.02, 100.0);
  result.eye = camera.target + distance * offset.normalized();
  return result;
}

render::Camera fitted(render::Camera camera, double aspect) {
  constexpr double kMadeFor = 4.0 / 3;
  if (aspect >= kMadeFor) return camera;
  const double half = camera.fov_y_deg * kDeg / 2;
  camera.fov_y_deg = 2 / kDeg * std::atan(std::tan(half) * kMadeFor / aspect);
  return camera;
}

bool same_camera(const render::Camera& a, const render::Camera& b) {
  return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov_y_deg == b.fov_y_deg &&
         a.orthographic == b.orthographic && a.ortho_height_m == b.ortho_height_m;
}

render::StepLook look_of(const State& state) {
  const ViewState& view = state.view;
  render::StepLook look;
  look.step = view.step;
  look.color_by = view.color_by;
  look.show_queue = view.show_queue;
  look.show_settled = view.show_settled;
  look.show_numerals = view.show_numerals;
  look.show_points = view.show_points;
  look.point_size = view.point_size;
  look.show_planes = view.show_planes;
  look.show_normals = view.show_normals;
  look.show_names = view.show_names;
  look.show_foot = view.show_foot;
  look.show_stairs = view.show_stairs;
  look.planes = state.plane_scene();
  look.node = view.selected.node;
  look.plane = view.selected.plane;
  look.voxel = view.selected.voxel;
  look.marked = state.document.marked;
  look.theme = view.theme;
  // Among finished planes nothing stands out that was not selected.
  look.show_current = state.run() && view.step < state.run()->steps();
  if (const planes::TraceEvent* event = look.show_current ? state.event() : nullptr) {
    const bool on_point = event->point >= 0 && event->point == look.voxel;
    if (event->node == look.node || on_point) look.node = -1;
    if (event->plane == look.plane) look.plane = -1;
    if (on_point) look.voxel = -1;
  }
  return look;
}

render::LabelLook label_look_of(const State& state) {
  const LabelView& view = state.view.label;
  render::LabelLook look;
  look.labels = state.labels();
  look.plane = view.plane;
  look.show_class = view.show_class;
  if (view.stroke) {
    look.preview = view.stroke->pixels;
    look.preview_takes = view.stroke->takes;
  } else if (view.wand.found) {
    look.preview = view.wand.found->pixels;
    look.preview_takes = view.paints == Paints::erase;
  }
  if (state.results.label.carry.done) look.doubt = state.results.label.carry.done->doubt;
  look.marked = marked_pixels(state);
  look.theme = state.view.theme;
  return look;
}

std::string describe_node(const State& state, std::int32_t node) {
  const debug::Run& run = *state.run();
  const planes::OctreeNode& what = run.octree().nodes[static_cast<std::size_t>(node)];
  std::string text = fmt::format("node {}, depth {}, {} points", node, what.depth, what.size());
  switch (run.timeline.node_state(node, state.view.step)) {
    case debug::NodeState::settled:
      return text + ", case " + planes::to_string(what.decided);
    case debug::NodeState::visited:
      return text + ", being judged";
    case debug::NodeState::queued:
      return text + ", in the queue";
    default:
      return text;
  }
}

std::string describe_voxel(const State& state, std::int32_t voxel) {
  const debug::Run& run = *state.run();
  const std::int32_t step = state.view.step;
  const planes::PointChange now = run.timeline.point_at(voxel, step);
  std::string text = fmt::format("voxel {}", voxel);
  if (run.is_ours()) {
    const std::vector<Label>& labels = run.subject->prepared.classification.labels;
    const Label label = labels[static_cast<std::size_t>(voxel)];
    text += label == Label::h ? " (h)" : label == Label::v ? " (v)" : "";
  }
  text += ", ";
  if (now.plane >= 0)
    text += "in " + debug::plane_name(*state.run(), now.plane);
  else
    text += now.leftover ? "left over" : "not settled";
  if (run.subject->voxel_truth.known()) {
    const std::int32_t truth = run.subject->voxel_truth.plane[static_cast<std::size_t>(voxel)];
    if (truth > 0) text += fmt::format(", true plane {}", truth);
  }
  // Why a plane has the colour that it has.
  const bool asks = state.view.color_by == render::ColorBy::steppable || state.view.show_foot;
  if (const std::string verdict = asks ? verdict_text(state, now.plane) : ""; !verdict.empty())
    text += "\n" + verdict;
  const std::int32_t node = run.timeline.node_of_point(voxel, step);
  return node >= 0 ? text + "\n" + describe_node(state, node) : text;
}

}  // namespace planescope::desktop
