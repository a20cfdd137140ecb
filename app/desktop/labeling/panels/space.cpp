// The points of the frame with their labels, and tools in space.

#include <fmt/format.h>

#include "app/desktop/labeling/surface.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"
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

DrawingSurface surface_of(const State& state, const ScenePlacement& placed) {
  const auto& [min, max, width, height] = placed;
  DrawingSurface surface;
  surface.where = DrawnIn::space;
  surface.width = width;
  surface.height = height;
  surface.min = surface.origin = min;
  surface.max = max;
  const double aspect = static_cast<double>(width) / height;
  surface.screen_of_pixel = [view = render::make_view(scene_camera(state, aspect), width, height),
                             frame = state.results.label.frame,
                             at = placed.min](std::uint32_t pixel) -> std::optional<ImVec2> {
    if (pixel >= frame->world.size() || !frame->grid.measured[pixel]) return std::nullopt;
    const std::optional<render::ScreenPoint> point = render::project(view, frame->world[pixel]);
    if (!point) return std::nullopt;
    return ImVec2(at.x + static_cast<float>(point->px.x()),
                  at.y + static_cast<float>(point->px.y()));
  };
  return surface;
}

void move_camera(const Ui& ui, int height) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemHovered() && !wheel_sizes(ui)) zoom_scene(ui);
  if (!ImGui::IsItemActive() || (io.MouseDelta.x == 0 && io.MouseDelta.y == 0)) return;
  const bool turns = ImGui::IsMouseDown(1) && !io.KeyShift;
  const bool left = ImGui::IsMouseDragging(0) && left_button_moves(ui);
  if (turns || left)
    orbit_scene(ui, height);
  else if (ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2))
    pan_scene(ui, height);
}

/// Says at all times whether strokes go through to hidden points.
void draw_through_badge(const Ui& ui, const DrawingSurface& surface) {
  const LabelView& view = ui.state.view.label;
  const bool drawing = ui.memory.label_drag.on && ui.memory.label_drag.where == DrawnIn::space;
  const std::size_t hidden = drawing && view.stroke ? view.stroke->hidden : view.hover_hidden;
  std::string text = view.through ? "through" : "visible only";
  if (hidden > 0) text += fmt::format("   {} hidden {}", hidden, view.through ? "taken" : "left");
  const ImVec2 at(surface.min.x + ui.px(8), surface.min.y + ui.px(8));
  const ImU32 plain = with_alpha(ui.colors.panel, 225);
  const float height = draw_badge(ui, at, text, view.through ? ui.colors.warning : plain,
                                  view.through ? ui.colors.panel : ui.colors.text);
  ui.name("label.through", at, ImVec2(at.x + ui.px(90), at.y + height));
}

}  // namespace

void draw_label_space(const Ui& ui) {
  draw_space_tools(ui);
  if (!ui.state.label_frame() || !ui.state.labels()) return draw_label_absence(ui);
  const auto placed =
      draw_scene_room(ui, [&](Canvas& canvas, const render::Camera& camera, int width, int height) {
        return canvas.label_scene(ui.state.results.label.frame, label_look_of(ui.state), camera,
                                  width, height);
      });
  if (!placed) return;
  const DrawingSurface surface = surface_of(ui.state, *placed);
  move_camera(ui, placed->height);
  use_label_tool(ui, surface);
  draw_label_overlay(ui, surface);
  draw_through_badge(ui, surface);
}

}  // namespace planescope::desktop
