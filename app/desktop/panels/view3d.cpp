// The scene at the cursor: turned with the left button, moved with the right, picked by a click.

#include <fmt/format.h>

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
                {render::ColorBy::labels, "color.labels", "h or v"},
                {render::ColorBy::margins, "color.margins", "sureness"},
                {render::ColorBy::truth, "color.truth", "truth"},
                {render::ColorBy::camera, "color.camera", "camera"},
                {render::ColorBy::steppable, "color.steppable", "steppable"}};
  const auto* chosen = &colors[static_cast<std::size_t>(ui.state.view.color_by)];
  ImGui::SetNextItemWidth(ui.px(96));
  const bool open = ImGui::BeginCombo("##color", chosen->title);
  ui.name("view3d.color");
  if (!open) tooltip("what colours tell apart   1 to 7\nh: level, v: upright");
  if (open) {
    for (const auto& color : colors) {
      if (ImGui::Selectable(color.title, &color == chosen)) ui.emit(color.action);
      ui.name(std::string("view3d.color.") + color.title);
    }
    ImGui::EndCombo();
  }
  static constexpr const char* kButtons[][2] = {
      {"show.queue", "queue"},   {"show.settled", "boxes"},    {"show.planes", "planes"},
      {"show.foot", "foot"},     {"show.stairs", "stairs"},    {"camera.home", "home"},
      {"camera.node", "node"},   {"camera.top", "top"},        {"camera.side", "side"},
      {"camera.front", "front"}, {"measure.points", "measure"}};
  for (const auto& [action, label] : kButtons) {
    if (!same_line_if_room(button_width(label), ImGui::GetStyle().ItemSpacing.x)) break;
    action_button(ui, action, label);
  }
}

void move_camera(const Ui& ui, int height) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool pan = ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2) || io.KeyShift;
  if (ImGui::IsItemActive() && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    if (pan)
      pan_scene(ui, height);
    else if (was_dragged())
      orbit_scene(ui, height);
  }
  zoom_scene(ui);
}

void select(const Ui& ui, const render::Picked& what) {
  if (const char* action = click_action(ui.state.view.click)) {
    if (what.kind == render::Picked::Kind::voxel)
      return ui.emit(action, fmt::format("voxel {}", what.index));
    if (what.kind == render::Picked::Kind::plane)
      return ui.emit(action, "plane " + debug::plane_name(*ui.state.run(), what.index));
    return ui.emit(action, "nothing");
  }
  switch (what.kind) {
    case render::Picked::Kind::voxel:
      return ui.emit("select.voxel", std::to_string(what.index));
    case render::Picked::Kind::node:
      return ui.emit("select.node", std::to_string(what.index));
    case render::Picked::Kind::plane:
      return ui.emit("select.plane", debug::plane_name(*ui.state.run(), what.index));
    default:
      return ui.emit("select.none");
  }
}

void tell(const Ui& ui, const render::Picked& what) {
  if (what.kind == render::Picked::Kind::voxel)
    ImGui::SetTooltip("%s", describe_voxel(ui.state, what.index).c_str());
  if (what.kind == render::Picked::Kind::node)
    ImGui::SetTooltip("%s", describe_node(ui.state, what.index).c_str());
  if (what.kind == render::Picked::Kind::plane)
    ImGui::SetTooltip("%s", describe_plane(ui.state, what.index).c_str());
}

}  // namespace

void draw_view3d(const Ui& ui) {
  draw_tools(ui);
  if (!ui.state.run()) return draw_absence(ui);
  if (ui.state.run()->subject->frame.is_cloud()) draw_click_line(ui);
  const auto placed =
      draw_scene_room(ui, [&](Canvas& canvas, const render::Camera& camera, int width, int height) {
        return canvas.scene(ui.state.run_view()->run, look_of(ui.state), camera, width, height);
      });
  if (!placed) return;
  draw_measured(ui, *placed);
  move_camera(ui, placed->height);
  if (ui.canvas && ImGui::IsItemHovered()) {
    const ImGuiIO& io = ImGui::GetIO();
    const bool pressed = ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
    const bool clicked = ImGui::IsMouseReleased(0) && !was_dragged();
    const bool playing = ui.state.view.playing.direction != 0;  // nobody reads that fast
    if (!pressed && (clicked || !playing)) {
      const render::Picked what = ui.canvas->pick(static_cast<int>(io.MousePos.x - placed->min.x),
                                                  static_cast<int>(io.MousePos.y - placed->min.y));
      if (clicked)
        select(ui, what);
      else
        tell(ui, what);
    }
    if (ImGui::IsMouseDoubleClicked(0) && ui.state.view.click == Click::selects)
      ui.emit("camera.node");
  }
  if (ui.state.view.flash) {
    ImDrawList* draw = ImGui::GetWindowDrawList();
    const ImVec2 corner(placed->max.x - ui.px(34), placed->min.y + ui.px(8));
    draw->AddRectFilled(corner, ImVec2(corner.x + ui.px(26), corner.y + ui.px(24)),
                        ui.colors.accent, ui.px(4));
    draw->AddText(ui.bold, ui.px(18), ImVec2(corner.x + ui.px(7), corner.y + ui.px(2)),
                  ui.colors.panel, "A");
  }
}

}  // namespace planescope::desktop
