// The scene at the cursor: turned with the left button, moved with the right, picked by a click.

#include <fmt/format.h>

#include <cmath>

#include "app/desktop/camera.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/toolbar.hpp"
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
                {render::ColorBy::camera, "color.camera", "camera"}};
  const auto* chosen = &colors[static_cast<std::size_t>(ui.state.view.color_by)];
  ImGui::SetNextItemWidth(ui.px(96));
  const bool open = ImGui::BeginCombo("##color", chosen->title);
  ui.name("view3d.color");
  if (!open && ImGui::IsItemHovered())
    ImGui::SetTooltip("what colours tell apart   1 to 6\nh, v: horizontal, vertical");
  if (open) {
    for (const auto& color : colors) {
      if (ImGui::Selectable(color.title, &color == chosen)) ui.emit(color.action);
      ui.name(std::string("view3d.color.") + color.title);
    }
    ImGui::EndCombo();
  }
  static constexpr const char* kButtons[][2] = {
      {"show.queue", "queue"}, {"show.settled", "boxes"}, {"show.planes", "planes"},
      {"camera.home", "home"}, {"camera.node", "node"},   {"camera.top", "top"},
      {"camera.side", "side"}, {"camera.front", "front"}};
  const float end = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  for (const auto& [action, label] : kButtons) {
    const float width = ImGui::CalcTextSize(label).x + 2 * ImGui::GetStyle().FramePadding.x;
    if (ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width > end) break;
    ImGui::SameLine();
    action_button(ui, action, label);
  }
}

void move_camera(const Ui& ui, float height) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool pan = ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2) || io.KeyShift;
  const ImVec2 moved = io.MouseDelta;
  if (ImGui::IsItemActive() && (moved.x != 0 || moved.y != 0)) {
    if (pan)
      ui.emit("camera.pan", fmt::format("{:.6g},{:.6g}", -moved.x / height, moved.y / height));
    else if (was_dragged())
      ui.emit("camera.orbit",
              fmt::format("{:.6g},{:.6g}", 250 * moved.x / height, 250 * moved.y / height));
  }
  if (ImGui::IsItemHovered() && io.MouseWheel != 0)
    ui.emit("camera.zoom", fmt::format("{:.6g}", std::pow(1.15, io.MouseWheel)));
}

void select(const Ui& ui, const render::Picked& what) {
  const GravityClick picks = ui.state.view.gravity_click;
  if (picks != GravityClick::none) {
    const char* action = picks == GravityClick::floor ? "gravity.floor" : "gravity.wall";
    if (what.kind == render::Picked::Kind::voxel)
      return ui.emit(action, fmt::format("voxel {}", what.index));
    if (what.kind == render::Picked::Kind::plane)
      return ui.emit(action, fmt::format("plane {}", what.index + 1));
    return ui.emit(action, "nothing");
  }
  switch (what.kind) {
    case render::Picked::Kind::voxel:
      return ui.emit("select.voxel", std::to_string(what.index));
    case render::Picked::Kind::node:
      return ui.emit("select.node", std::to_string(what.index));
    case render::Picked::Kind::plane:
      return ui.emit("select.plane", std::to_string(what.index + 1));
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
    ImGui::SetTooltip("%s", debug::plane_name(what.index).c_str());
}

}  // namespace

void draw_view3d(const Ui& ui) {
  draw_tools(ui);
  if (!ui.state.run()) return draw_absence(ui);
  if (ui.state.run()->subject->frame.is_cloud()) draw_gravity_line(ui);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const int width = static_cast<int>(room.x), height = static_cast<int>(room.y);
  if (width < 16 || height < 16) return;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  if (ui.canvas) {
    const TextureId texture = ui.canvas->scene(ui.state.run_view()->run, look_of(ui.state),
                                               fitted(camera_of(ui.state), w / h), width, height);
    // Row 0 of the texture is at the bottom.
    ImGui::GetWindowDrawList()->AddImage(reinterpret_cast<ImTextureID>(texture), at,
                                         ImVec2(at.x + w, at.y + h), ImVec2(0, 1), ImVec2(1, 0));
  }
  ImGui::InvisibleButton("scene", ImVec2(w, h),
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  ui.name("view3d");
  move_camera(ui, h);
  if (ui.canvas && ImGui::IsItemHovered()) {
    const ImGuiIO& io = ImGui::GetIO();
    const bool pressed = ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
    const bool clicked = ImGui::IsMouseReleased(0) && !was_dragged();
    const bool playing = ui.state.view.playing.direction != 0;  // nobody reads that fast
    if (!pressed && (clicked || !playing)) {
      const render::Picked what = ui.canvas->pick(static_cast<int>(io.MousePos.x - at.x),
                                                  static_cast<int>(io.MousePos.y - at.y));
      if (clicked)
        select(ui, what);
      else
        tell(ui, what);
    }
    if (ImGui::IsMouseDoubleClicked(0)) ui.emit("camera.node");
  }
  if (ui.state.view.flash) {
    ImDrawList* draw = ImGui::GetWindowDrawList();
    const ImVec2 corner(at.x + w - ui.px(34), at.y + ui.px(8));
    draw->AddRectFilled(corner, ImVec2(corner.x + ui.px(26), corner.y + ui.px(24)),
                        ui.colors.accent, ui.px(4));
    draw->AddText(ui.bold, ui.px(18), ImVec2(corner.x + ui.px(7), corner.y + ui.px(2)),
                  ui.colors.panel, "A");
  }
}

}  // namespace planescope::desktop
