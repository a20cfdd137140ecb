// The camera's image with its labels over it, and tools on it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/image_placement.hpp"
#include "app/desktop/labeling/label_look.hpp"
#include "app/desktop/labeling/label_overlay.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/toolbar.hpp"

namespace planescope::desktop {
namespace {

DrawingSurface surface_of(const ImagePlacement& placed) {
  DrawingSurface surface;
  surface.where = DrawnIn::image;
  surface.min = placed.area_min;
  surface.max = placed.area_max;
  surface.origin = placed.origin;
  surface.scale = placed.scale;
  surface.screen_of_pixel = [placed](std::uint32_t pixel) -> std::optional<ImVec2> {
    const auto width = static_cast<std::uint32_t>(placed.width);
    return placed.to_screen(static_cast<float>(pixel % width) + 0.5f,
                            static_cast<float>(pixel / width) + 0.5f);
  };
  return surface;
}

void move_image(const Ui& ui, const ImagePlacement& placed) {
  const ImGuiIO& io = ImGui::GetIO();
  const double zoom = ui.state.view.image_zoom;
  if (ImGui::IsItemHovered() && io.MouseWheel != 0 && !wheel_sizes(ui))
    show_image_part(ui, placed, zoom * std::pow(1.2, io.MouseWheel), placed.to_image(io.MousePos),
                    io.MousePos);
  const bool dragged = ImGui::IsMouseDragging(0) && left_button_moves(ui.state);
  const bool moves = dragged || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
  if (!ImGui::IsItemActive() || !moves || (io.MouseDelta.x == 0 && io.MouseDelta.y == 0)) return;
  const ImVec2 before(io.MousePos.x - io.MouseDelta.x, io.MousePos.y - io.MouseDelta.y);
  show_image_part(ui, placed, zoom, placed.to_image(before), io.MousePos);
}

}  // namespace

void draw_label_image(const Ui& ui) {
  draw_image_tools(ui, "how strongly labels cover the camera's image");
  const LabelFrame* frame = ui.state.label_frame();
  if (!frame || !ui.state.labels()) return draw_label_absence(ui);
  draw_gravity_line(ui);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.x < 16 || room.y < 16) return;
  const ViewState& view = ui.state.view;
  const ImagePlacement placed =
      place_image(view, ImGui::GetCursorScreenPos(), room, frame->grid.width, frame->grid.height);
  const ImVec2 first = placed.to_screen(0, 0);
  const ImVec2 last = placed.to_screen(static_cast<float>(frame->grid.width),
                                       static_cast<float>(frame->grid.height));
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->PushClipRect(placed.area_min, placed.area_max, true);
  draw->AddRectFilled(placed.area_min, placed.area_max, ui.colors.panel);
  if (ui.canvas) {
    const TextureId texture = ui.canvas->label_image(
        ui.state.results.label.frame, label_look_of(ui.state), view.backdrop, view.overlay_opacity);
    draw->AddImage(reinterpret_cast<ImTextureID>(texture), first, last);
  }
  draw->PopClipRect();
  ImGui::InvisibleButton("pixels", room,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  // Of the image itself, so that shares of the widget are shares of the image.
  ui.name("image", first, last);
  const DrawingSurface surface = surface_of(placed);
  move_image(ui, placed);
  use_label_tool(ui, surface);
  draw_label_overlay(ui, surface);
}

}  // namespace planescope::desktop
