// The camera's image with its labels over it, and tools on it.

#include <fmt/format.h>

#include "app/desktop/labeling/surface.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/views.hpp"

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
                            static_cast<float>(pixel / width) + 0.5f);  // NOLINT: whole rows
  };
  return surface;
}

void move_image(const Ui& ui, const ImagePlacement& placed) {
  if (ImGui::IsItemHovered() && !wheel_sizes(ui)) zoom_image(ui, placed);
  const bool dragged = ImGui::IsMouseDragging(0) && left_button_moves(ui);
  if (dragged || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2)) drag_image(ui, placed);
}

}  // namespace

void draw_label_image(const Ui& ui) {
  draw_image_tools(ui, "Opacity of the labels");
  const LabelFrame* frame = ui.state.label_frame();
  if (!frame || !ui.state.labels()) return draw_label_absence(ui);
  draw_click_line(ui);
  const ViewState& view = ui.state.view;
  const labels::LabelGrid& grid = frame->grid;
  const auto placed = draw_image_room(ui, grid.width, grid.height, [&](Canvas& canvas) {
    return canvas.label_image(ui.state.results.label.frame, label_look_of(ui.state), view.backdrop,
                              view.overlay_opacity);
  });
  if (!placed) return;
  const DrawingSurface surface = surface_of(*placed);
  move_image(ui, *placed);
  use_label_tool(ui, surface);
  draw_label_overlay(ui, surface);
}

}  // namespace planescope::desktop
