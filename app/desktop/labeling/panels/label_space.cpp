// The points of the frame with their labels, and tools in space.

#include <fmt/format.h>

#include <cmath>

#include "app/desktop/camera.hpp"
#include "app/desktop/labeling/label_look.hpp"
#include "app/desktop/labeling/label_overlay.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/toolbar.hpp"
#include "render/view.hpp"

namespace planescope::desktop {
namespace {

void draw_space_tools(const Ui& ui) {
  action_button(ui, "label.classes", "h / v");
  for (const auto& [action, label] : {std::pair{"camera.home", "home"},
                                      {"camera.top", "top"},
                                      {"camera.side", "side"},
                                      {"camera.front", "front"}}) {
    ImGui::SameLine();
    action_button(ui, action, label);
  }
}

DrawingSurface surface_of(const State& state, ImVec2 at, int width, int height) {
  DrawingSurface surface;
  surface.where = DrawnIn::space;
  surface.width = width;
  surface.height = height;
  surface.min = surface.origin = at;
  surface.max = ImVec2(at.x + static_cast<float>(width), at.y + static_cast<float>(height));
  const double aspect = static_cast<double>(width) / height;
  surface.screen_of_pixel =
      [view = render::make_view(fitted(camera_of(state), aspect), width, height),
       frame = state.results.label.frame, at](std::uint32_t pixel) -> std::optional<ImVec2> {
    if (pixel >= frame->world.size() || !frame->grid.measured[pixel]) return std::nullopt;
    const std::optional<render::ScreenPoint> point = render::project(view, frame->world[pixel]);
    if (!point) return std::nullopt;
    return ImVec2(at.x + static_cast<float>(point->px.x()),
                  at.y + static_cast<float>(point->px.y()));
  };
  return surface;
}

void move_camera(const Ui& ui, float height) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemHovered() && io.MouseWheel != 0 && !wheel_sizes(ui))
    ui.emit("camera.zoom", fmt::format("{:.6g}", std::pow(1.15, io.MouseWheel)));
  const ImVec2 moved = io.MouseDelta;
  if (!ImGui::IsItemActive() || (moved.x == 0 && moved.y == 0)) return;
  const bool turns = ImGui::IsMouseDown(1) && !io.KeyShift;
  const bool left = ImGui::IsMouseDragging(0) && left_button_moves(ui.state);
  if (turns || left)
    ui.emit("camera.orbit",
            fmt::format("{:.6g},{:.6g}", 250 * moved.x / height, 250 * moved.y / height));
  else if (ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2))
    ui.emit("camera.pan", fmt::format("{:.6g},{:.6g}", -moved.x / height, moved.y / height));
}

/// Whether strokes go through to hidden points is never left to guess.
void draw_through_badge(const Ui& ui, const DrawingSurface& surface) {
  const LabelView& view = ui.state.view.label;
  const bool drawing = ui.memory.label_drag.on && ui.memory.label_drag.where == DrawnIn::space;
  const std::size_t hidden = drawing && view.stroke ? view.stroke->hidden : view.hover_hidden;
  std::string text = view.through ? "through" : "visible only";
  if (hidden > 0) text += fmt::format("   {} hidden {}", hidden, view.through ? "taken" : "left");
  const ImVec2 at(surface.min.x + ui.px(8), surface.min.y + ui.px(8));
  const ImU32 plain = (ui.colors.panel & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 225);
  const float height = draw_badge(ui, at, text, view.through ? ui.colors.warning : plain,
                                  view.through ? ui.colors.panel : ui.colors.text);
  ui.name("label.through", at, ImVec2(at.x + ui.px(90), at.y + height));
}

}  // namespace

void draw_label_space(const Ui& ui) {
  draw_space_tools(ui);
  if (!ui.state.label_frame() || !ui.state.labels()) return draw_label_absence(ui);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const int width = static_cast<int>(room.x), height = static_cast<int>(room.y);
  if (width < 16 || height < 16) return;
  const DrawingSurface surface = surface_of(ui.state, ImGui::GetCursorScreenPos(), width, height);
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  if (ui.canvas) {
    const TextureId texture =
        ui.canvas->label_scene(ui.state.results.label.frame, label_look_of(ui.state),
                               fitted(camera_of(ui.state), w / h), width, height);
    // Row 0 of the texture is at the bottom.
    ImGui::GetWindowDrawList()->AddImage(reinterpret_cast<ImTextureID>(texture), surface.min,
                                         surface.max, ImVec2(0, 1), ImVec2(1, 0));
  }
  ImGui::InvisibleButton("scene", ImVec2(w, h),
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  ui.name("view3d");
  move_camera(ui, h);
  use_label_tool(ui, surface);
  draw_label_overlay(ui, surface);
  draw_through_badge(ui, surface);
}

}  // namespace planescope::desktop
