// The scene at the cursor: turned with the left button, moved with the right, picked by a click; a
// click of the right button opens a menu.

#include <fmt/format.h>

#include <functional>

#include "app/desktop/debugger/plane_text.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

void draw_tools(const Ui& ui) {
  static const struct {
    render::ColorBy by;
    const char* action;
    const char* title;
  } colors[] = {{render::ColorBy::cases, "color.cases", "case"},
                {render::ColorBy::planes, "color.planes", "plane"},
                {render::ColorBy::labels, "color.labels", "horizontal or vertical"},
                {render::ColorBy::margins, "color.margins", "sureness"},
                {render::ColorBy::truth, "color.truth", "truth"},
                {render::ColorBy::camera, "color.camera", "camera"},
                {render::ColorBy::steppable, "color.steppable", "steppable"},
                {render::ColorBy::depth, "color.depth", "depth"},
                {render::ColorBy::height, "color.height", "height"},
                {render::ColorBy::rms, "color.rms", "RMS"},
                {render::ColorBy::distance, "color.distance", "distance"}};
  const auto* chosen = &colors[static_cast<std::size_t>(ui.state.view.color_by)];
  ImGui::SetNextItemWidth(ui.px(96));
  const bool open = ImGui::BeginCombo("##color", chosen->title);
  ui.name("view3d.color");
  if (!open) tooltip("Color by   1 to 9, 0, Shift+0");
  if (open) {
    for (const auto& color : colors) {
      if (ImGui::Selectable(color.title, &color == chosen)) ui.emit(color.action);
      ui.name(std::string("view3d.color.") + color.title);
    }
    ImGui::EndCombo();
  }
  static constexpr ToolButton kButtons[] = {
      {"show.queue", "queue"},       {"show.settled", "boxes"},       {"show.planes", "planes"},
      {"show.foot", "foot"},         {"show.stairs", "stairs"},       {"camera.home", "home"},
      {"camera.selected", "frame"},  {"camera.top", "top"},           {"camera.side", "side"},
      {"camera.front", "front"},     {"camera.orthographic", "flat"}, {"isolate", "isolate"},
      {"measure.points", "measure"}, {"views.next", "views"}};
  toolbar(ui, "view3d.more", kButtons);
}

void move_by_mouse(const Ui& ui, int height) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool right = ImGui::IsMouseDown(1), middle = ImGui::IsMouseDown(2);
  const bool pans = (right && was_dragged(1)) || middle || io.KeyShift;
  if (ImGui::IsItemActive() && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    if (pans)
      pan_scene(ui, height);
    else if (was_dragged() && !right)
      orbit_scene(ui, height);
  }
  zoom_scene(ui);
}

render::Picked seen_at_mouse(const Ui& ui, const ScenePlacement& placed) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (!ui.canvas) return {};
  return ui.canvas->pick(static_cast<int>(mouse.x - placed.min.x),
                         static_cast<int>(mouse.y - placed.min.y), static_cast<int>(ui.px(4)));
}

/// What is seen at the mouse or, where nothing is, the depth pixel of that place.
PointedAt pointed_at(const Ui& ui, const ScenePlacement& placed) {
  PointedAt found{.what = seen_at_mouse(ui, placed)};
  if (found.what.kind != render::Picked::Kind::nothing) return found;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const double aspect = static_cast<double>(placed.width) / placed.height;
  const render::View view =
      render::make_view(scene_camera(ui.state, aspect), placed.width, placed.height);
  if (const auto pixel = pixel_of_nothing(*ui.state.run()->subject, view,
                                          Vec2d(mouse.x - placed.min.x, mouse.y - placed.min.y)))
    found.source = static_cast<std::int64_t>(*pixel);
  return found;
}

void select(const Ui& ui, const PointedAt& at) {
  const render::Picked& what = at.what;
  if (const char* action = click_action(ui.state.view.click)) {
    if (what.kind == render::Picked::Kind::voxel)
      return ui.emit(action, fmt::format("voxel {}", what.index));
    if (what.kind == render::Picked::Kind::plane)
      return ui.emit(action, "plane " + debug::plane_name(*ui.state.run(), what.index));
    return ui.emit(action, "nothing");
  }
  const int width = ui.state.run()->subject->frame.depth.width;
  switch (what.kind) {
    case render::Picked::Kind::voxel:
      return ui.emit(ImGui::GetIO().KeyCtrl && ui.state.view.selected.voxel >= 0 ? "join.show"
                                                                                 : "select.voxel",
                     std::to_string(what.index));
    case render::Picked::Kind::node:
      return ui.emit("select.node", std::to_string(what.index));
    case render::Picked::Kind::plane:
      return ui.emit("select.plane", debug::plane_name(*ui.state.run(), what.index));
    default:
      if (at.source < 0) return ui.emit("select.none");
      return ui.emit("why.pixel", fmt::format("{},{}", at.source % width, at.source / width));
  }
}

void tell(const Ui& ui, const render::Picked& what) {
  if (what.kind == render::Picked::Kind::voxel)
    tooltip_at_mouse(describe_voxel(ui.state, what.index));
  if (what.kind == render::Picked::Kind::node)
    tooltip_at_mouse(describe_node(ui.state, what.index));
  if (what.kind == render::Picked::Kind::plane)
    tooltip_at_mouse(describe_plane(ui.state, what.index));
}

}  // namespace

void draw_view3d(const Ui& ui) {
  if (draw_camera_setup(ui)) return;
  draw_tools(ui);
  if (!ui.state.run()) return draw_absence(ui);
  if (!shows_image(ui.state)) draw_click_line(ui);
  using Picture = std::function<TextureId(Canvas&, const render::Camera&, int, int)>;
  const RunView* other = ui.state.other_view();
  const Picture here = [&](Canvas& canvas, const render::Camera& camera, int width, int height) {
    return canvas.scene(ui.state.run_view()->run, look_of(ui.state), camera, width, height);
  };
  const Picture beside = [&](Canvas& canvas, const render::Camera& camera, int width, int height) {
    return canvas.scene(other->run, other_look_of(ui.state), camera, width, height, Side::beside);
  };
  const auto placed = draw_scene_room(ui, here, other ? beside : Picture());
  if (!placed) return;
  draw_color_scale(ui, placed->min, placed->max);
  draw_measured(ui, *placed);
  move_by_mouse(ui, placed->height);
  std::optional<PointedAt> clicked;
  const bool here_below = mouse_is_here(ui, placed->min, placed->max);
  if (ImGui::IsItemHovered() && !here_below) tooltip("The other run; Space switches to it");
  if (ImGui::IsItemHovered() && here_below) {
    const bool pressed = ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
    const bool released = ImGui::IsMouseReleased(0) && !was_dragged();
    const bool playing = ui.state.view.playing.direction != 0;  // nobody reads that fast
    if (ImGui::IsMouseReleased(1) && !was_dragged(1)) clicked = pointed_at(ui, *placed);
    if (!pressed && !clicked && (released || !playing)) {
      if (released)
        select(ui, pointed_at(ui, *placed));
      else
        tell(ui, seen_at_mouse(ui, *placed));
    }
    if (ImGui::IsMouseDoubleClicked(0) && ui.state.view.click == Click::selects)
      ui.emit("camera.selected");
  }
  draw_context_menu(ui, clicked);
  draw_sides(ui, "view3d", placed->min, placed->max);
}

}  // namespace planescope::desktop
