// Cameras and draw settings derived from the desktop state.

#include "app/desktop/look.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "app/desktop/debugger/debugger.hpp"
#include "core/debug/explain/provenance.hpp"
#include "render/step_scene.hpp"

namespace planescope::desktop {
namespace {

constexpr double kDeg = 0.017453292519943295;  // [rad]

template <typename T>
const T* item(const std::vector<T>& items, int index) {
  return index >= 0 && index < static_cast<int>(items.size())
             ? &items[static_cast<std::size_t>(index)]
             : nullptr;
}

/// Pixels of the selected finding or disagreement in the open tab.
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

/// A view narrower than 4:3 keeps the horizontal field of view of 4:3.
double fov_y_deg(double aspect) {
  constexpr double kOf = 45, kMadeFor = 4.0 / 3;
  if (aspect >= kMadeFor) return kOf;
  return 2 / kDeg * std::atan(std::tan(kOf * kDeg / 2) * kMadeFor / aspect);
}

render::Lens lens_of(const State& state, double aspect) {
  return {
      .fov_y_deg = fov_y_deg(aspect), .aspect = aspect, .orthographic = state.view.orthographic};
}

/// A camera that shows the whole frame, with gravity pointing down.
render::Camera whole_camera(const State& state, double aspect) {
  // Use the current run even while another is shown, so that the view does not jump.
  const RunView* view = state.results.current ? state.results.current.get() : state.run_view();
  if (!view) return {};
  const render::Home& home = view->home;
  const Vec3d level(home.forward.x(), home.forward.y(), 0);
  const Vec3d ahead = level.norm() > 1e-9 ? Vec3d(level.normalized()) : Vec3d(Vec3d::UnitX());
  render::Lens lens = lens_of(state, aspect);
  switch (state.view.facing) {
    case Facing::home:
      lens.forward = home.forward;
      break;
    case Facing::top:
      lens.forward = -Vec3d::UnitZ();
      lens.up = ahead;
      break;
    case Facing::side:
      lens.forward = -ahead.cross(Vec3d::UnitZ());
      break;
    case Facing::front:
      lens.forward = ahead;
  }
  return render::camera_fitting(home.extent, lens);
}

/// Comparison of A and B; null while unknown.
const debug::Comparison* comparison_with_a(const Results& results) {
  const bool known = results.comparison && results.compared_a == results.pinned &&
                     results.compared_b == results.current;
  return known ? results.comparison.get() : nullptr;
}

/// Returns the matching plane of the other run, or -1 if unknown.
std::int32_t matching_plane(const State& state, std::int32_t plane) {
  const debug::Comparison* comparison = comparison_with_a(state.results);
  const std::int32_t id = state.run()->timeline.result_of_plane(plane);
  if (!comparison || id == 0) return -1;
  for (const debug::PlanePair& pair : comparison->planes) {
    const int here = state.view.flash ? pair.a : pair.b, there = state.view.flash ? pair.b : pair.a;
    if (here == id && there > 0) return state.other_view()->run->timeline.plane_of_number(there);
  }
  return -1;
}

}  // namespace

render::Camera camera_of(const State& state) {
  if (!state.view.camera) return whole_camera(state, state.view.scene_aspect);
  render::Camera camera = *state.view.camera;
  camera.fov_y_deg = fov_y_deg(state.view.scene_aspect);
  return camera;
}

render::Camera scene_camera(const State& state, double aspect) {
  render::Camera camera = state.view.camera ? *state.view.camera : whole_camera(state, aspect);
  camera.fov_y_deg = fov_y_deg(aspect);
  if (!state.view.orthographic) return camera;
  // Same extent at the target's distance, from far enough that nothing is behind the eye.
  const Vec3d back = camera.eye - camera.target;
  camera.orthographic = true;
  camera.ortho_height_m = 2 * back.norm() * std::tan(camera.fov_y_deg * kDeg / 2);
  camera.eye = camera.target + camera.far_m / 2 * back.normalized();
  return camera;
}

std::vector<Vec3f> selected_points(const State& state) {
  const debug::Run& run = *state.run();
  const Selection& selected = state.view.selected;
  if (selected.voxel >= 0) {
    // The voxel and enough of its surroundings for context.
    const Vec3f at = run.subject->prepared.voxels.points[static_cast<std::size_t>(selected.voxel)];
    const auto reach_m = static_cast<float>(8 * run.subject->prepared.voxels.size_m);
    std::vector<Vec3f> around;
    for (int i = 0; i < 6; ++i)
      around.push_back(at + (i % 2 == 0 ? reach_m : -reach_m) * Vec3f::Unit(i / 2));
    return around;
  }
  if (selected.plane >= 0) return render::plane_points(run, selected.plane, state.view.step);
  if (selected.node >= 0) return render::node_points(run, selected.node);
  std::vector<Vec3f> marked;
  for (const std::uint32_t voxel : state.document.marked)
    if (voxel < run.subject->voxel_count())
      marked.push_back(run.subject->prepared.voxels.points[voxel]);
  return marked;
}

render::Camera camera_on(const State& state, std::span<const Vec3f> points) {
  constexpr double kRoom = 1.3;  // leaves some surroundings visible
  const render::Camera now = camera_of(state);
  render::Lens lens = lens_of(state, state.view.scene_aspect);
  lens.forward = (now.target - now.eye).normalized();
  lens.up = now.up;
  lens.room = kRoom;
  return render::camera_fitting(render::extent_of(points, 0), lens);
}

render::Camera orbited(const render::Camera& camera, double right_deg, double up_deg) {
  const Vec3d offset = camera.eye - camera.target;
  const double distance = offset.norm();
  double azimuth = std::atan2(offset.y(), offset.x());
  const double elevation = std::asin(std::clamp(offset.z() / distance, -1.0, 1.0));
  if (camera.up.z() < 0.5 && std::abs(offset.z()) > 0.999 * distance)  // from above: use `up`
    azimuth = std::atan2(-camera.up.y(), -camera.up.x());
  // Stop just short of the pole, so that up remains up.
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

bool same_camera(const render::Camera& a, const render::Camera& b) {
  return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov_y_deg == b.fov_y_deg &&
         a.orthographic == b.orthographic && a.ortho_height_m == b.ortho_height_m;
}

render::StepLook look_of(const State& state) {
  const ViewState& view = state.view;
  render::StepLook look{view};
  look.step = view.step;
  look.planes = state.plane_scene(state.run_view());
  if (view.show_map) look.map = state.run_view()->map_lines;
  look.node = view.selected.node;
  look.plane = view.selected.plane;
  look.voxel = view.selected.voxel;
  look.marked = state.document.marked;
  look.color_of_plane = colors_of_planes(state, *state.run_view());
  if (look.color_by == render::ColorBy::truth)
    look.color_of_truth = colors_of_truth(state, *state.run_view());
  // At the end of the run, highlight only the user's selection.
  look.show_current = state.run() && view.step < state.run()->steps();
  if (const planes::TraceEvent* event = look.show_current ? state.event() : nullptr) {
    const bool on_point = event->point >= 0 && event->point == look.voxel;
    if (look.node == debug::node_at_step(*state.run(), view.step)) look.node = -1;
    if (event->plane == look.plane) look.plane = -1;
    if (on_point) look.voxel = -1;
  }
  return look;
}

render::StepLook other_look_of(const State& state) {
  const debug::Run& here = *state.run();
  const RunView& beside = *state.other_view();
  const debug::Run& there = *beside.run;
  const debug::Correspondence same(here, there);
  render::StepLook look = look_of(state);
  const bool at_end = look.step == here.steps();
  look.step = at_end ? there.steps() : debug::same_step(here, look.step, there);
  look.show_current = !at_end;
  look.planes = state.plane_scene(&beside);
  look.color_of_plane = colors_of_planes(state, beside);
  if (look.color_by == render::ColorBy::truth) look.color_of_truth = colors_of_truth(state, beside);
  if (look.node >= 0) look.node = same.node(look.node);
  if (look.voxel >= 0) look.voxel = same.voxel(look.voxel);
  if (!same.same_voxels()) look.marked = {};
  if (look.plane >= 0) look.plane = matching_plane(state, look.plane);
  if (render::is_along_scale(look.color_by))  // same colors for the same values
    look.range = render::color_scale(here, look_of(state)).range;
  return look;
}

const FrameColors& shown_colors(const State& state, const RunView& of) {
  if (&of == state.results.pinned.get()) return state.results.pinned_colors;
  const std::vector<Thumbnail>& strip = state.results.strip;
  const int frame = of.run->subject->frame.index;
  if (frame >= std::ssize(strip)) return of.colors;
  const FrameColors& there = strip[static_cast<std::size_t>(frame)].colors;
  const bool same =
      there.planes && there.key == of.colors.key && there.of_tracks == of.colors.of_tracks;
  return same ? there : of.colors;
}

std::vector<int> colors_of_planes(const State& state, const RunView& of) {
  const FrameColors& colors = shown_colors(state, of);
  return colors.planes ? render::trace_colors(*of.run, colors.planes->own_colors())
                       : std::vector<int>();
}

std::vector<int> colors_of_truth(const State& state, const RunView& of) {
  const FrameColors& found = shown_colors(state, of);
  std::vector<int> colors;
  if (!found.planes) return colors;
  const std::vector<int> of_shown =
      render::true_plane_colors(of.truth.image, of.truth.found_of, found.planes->own_colors());
  for (std::size_t k = 0; k < of_shown.size(); ++k) {
    colors.resize(static_cast<std::size_t>(of.truth.ids[k]), 0);
    colors.back() = of_shown[k];
  }
  return colors;
}

render::LabelLook label_look_of(const State& state) {
  const LabelView& view = state.view.label;
  render::LabelLook look;
  look.labels = state.labels();
  look.plane = view.plane;
  look.show_class = view.show_class;
  look.edit = view.stroke ? view.stroke : view.finish;
  if (!look.edit && view.wand.found) {
    look.preview = view.wand.found->pixels;
    look.preview_takes = view.paints == Paints::erase;
  }
  if (state.results.label.carry.done) look.doubt = state.results.label.carry.done->doubt;
  look.marked = marked_pixels(state);
  look.residual = residual_of(state);
  look.theme = state.view.theme;
  return look;
}

std::optional<render::Residual> residual_of(const State& state) {
  constexpr double kTolerances = 2;  // range of the scale in tolerances, in each direction
  const LabelView& view = state.view.label;
  const std::shared_ptr<const FrameLabels> labels = state.labels();
  if (!view.show_residual || !labels) return std::nullopt;
  const double most_m = kTolerances * view.wand_options.tolerance_m;
  if (view.wand.found) {
    const labels::FittedPlane& plane = view.wand.found->plane;
    return render::Residual{0, plane.normal, plane.offset_m, most_m, "wand"};
  }
  const LabelPlane* plane = labels::find_plane(*labels, view.plane);
  if (!plane) return std::nullopt;
  return render::Residual{plane->id, plane->normal, plane->offset_m, most_m,
                          fmt::format("P{}", plane->id)};
}

std::string describe_node(const State& state, std::int32_t node) {
  const debug::Run& run = *state.run();
  const planes::OctreeNode& what = run.octree().nodes[static_cast<std::size_t>(node)];
  std::string text = fmt::format("node {}, depth {}, {} points", node, what.depth, what.size());
  switch (run.timeline.node_state(node, state.view.step)) {
    case debug::NodeState::settled:
      return text + ", case " + planes::to_string(what.decided);
    case debug::NodeState::visited:
      return text + ", being evaluated";
    case debug::NodeState::queued:
      return text + ", queued";
    default:
      return text;
  }
}

std::string describe_voxel(const State& state, std::int32_t voxel) {
  const debug::Run& run = *state.run();
  const std::int32_t step = state.view.step;
  const planes::PointChange now = run.timeline.point_at(voxel, step);
  std::string text = debug::point_name(run, voxel);
  if (run.is_ours()) {
    const std::vector<Label>& labels = run.subject->prepared.classification.labels;
    const Label label = labels[static_cast<std::size_t>(voxel)];
    text += label == Label::h ? " (h)" : label == Label::v ? " (v)" : "";
  }
  text += ", ";
  if (now.plane >= 0)
    text += "in " + debug::plane_name(*state.run(), now.plane);
  else
    text += now.leftover ? "unassigned" : "not visited yet";
  if (run.subject->voxel_truth.known()) {
    const std::int32_t truth = run.subject->voxel_truth.plane[static_cast<std::size_t>(voxel)];
    if (truth > 0) text += fmt::format(", true plane {}", truth);
  }
  // Explain the color of the plane.
  const bool asks = state.view.color_by == render::ColorBy::steppable || state.view.show_foot;
  if (const std::string verdict = asks ? verdict_text(state, now.plane) : ""; !verdict.empty())
    text += "\n" + verdict;
  if (render::is_along_scale(state.view.color_by))
    if (const std::string value = render::value_text(run, look_of(state), voxel); !value.empty())
      text += "\n" + value;
  const std::int32_t node = run.timeline.node_of_point(voxel, step);
  return node >= 0 ? text + "\n" + describe_node(state, node) : text;
}

}  // namespace planescope::desktop
