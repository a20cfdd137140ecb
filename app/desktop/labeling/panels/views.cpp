// The toolbar above both views of label mode, and the views in which tools work.

#include "app/desktop/views.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/labeling/surface.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/labels/edit/operations.hpp"
#include "render/draw_list.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {

// ---- Toolbar: tools, active plane, sizes. Items without room are also in the menus --------------

namespace {

void draw_tool_buttons(const Ui& ui) {
  static constexpr const char* kButtons[][2] = {
      {"label.tool.wand", "wand"},      {"label.tool.brush", "brush"},
      {"label.tool.rectangle", "rect"}, {"label.tool.lasso", "lasso"},
      {"label.tool.polygon", "poly"},   {"label.tool.cut", "cut"}};
  bool first = true;
  for (const auto& [action, label] : kButtons) {
    if (!first && !same_line_if_room(button_width(label), ui.px(3))) return;
    first = false;
    action_button(ui, action, label);
  }
}

/// Shows the effect of the next gesture: a swatch with its name.
void draw_paint(const Ui& ui) {
  const LabelView& view = ui.state.view.label;
  const FrameLabels* labels = ui.state.labels().get();
  std::string text;
  render::Rgba color{120, 124, 130};
  switch (view.paints) {
    case Paints::plane: {
      const LabelPlane* plane = labels ? labels::find_plane(*labels, view.plane) : nullptr;
      text = view.plane == 0 ? "new plane" : fmt::format("P{}", view.plane);
      if (view.plane > 0) color = render::plane_color(view.plane);
      if (plane)
        text += plane->label == Label::h ? " h" : plane->label == Label::v ? " v" : "";
      else if (view.plane > 0)
        text += " new";
      if (plane && plane->locked) text += ", locked";
      break;
    }
    case Paints::ignore:
      text = "ignore";
      break;
    case Paints::erase:
      text = "erase";
      break;
    default:
      color = render::label_color(view.paints == Paints::h_only ? Label::h : Label::v);
      text = view.paints == Paints::h_only ? "horizontal only" : "vertical only";
  }
  const float side = ImGui::GetTextLineHeight();
  const float width = side + ui.px(5) + ImGui::CalcTextSize(text.c_str()).x;
  if (!same_line_if_room(width, ui.px(14))) return;
  ImGui::AlignTextToFramePadding();
  ImVec2 at = ImGui::GetCursorScreenPos();
  at.y += ImGui::GetStyle().FramePadding.y;
  ImGui::BeginGroup();
  ImGui::Dummy(ImVec2(side, side));
  ImGui::SameLine(0, ui.px(5));
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text.c_str());
  ImGui::EndGroup();
  ImGui::GetWindowDrawList()->AddRectFilled(at, ImVec2(at.x + side, at.y + side), to_imgui(color),
                                            ui.px(3));
  ui.name("label.paint");
  tooltip(
      "Plane or class that the next gesture paints\n1 to 9 and Tab choose a plane, N a new one, P "
      "the one under "
      "the mouse\nI paints \"do not score\", 0 erases");
}

/// Shows the brush's radius or the wand's tolerance.
void draw_size(const Ui& ui) {
  const LabelView& view = ui.state.view.label;
  const bool wand = view.tool == LabelTool::wand;
  if (!wand && view.tool != LabelTool::brush) return;
  auto value = static_cast<float>(wand ? 1000 * view.wand_options.tolerance_m : view.brush_px);
  const std::string text = wand ? fmt::format("{:.1f} mm", value) : fmt::format("{:.0f} px", value);
  const float slider = ui.px(80), number = ImGui::CalcTextSize("88.8 mm").x;
  if (!same_line_if_room(slider + number, ui.px(14))) return;
  // Draw the number beside the slider, where the grab cannot hide it.
  ImGui::SetNextItemWidth(slider);
  if (ImGui::SliderFloat("##size", &value, 1, wand ? 40 : 100, "",
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp)) {
    if (wand)
      ui.act("label.wand.tolerance", value / 1000.0);
    else
      ui.act("label.brush", value);
  }
  ui.name("label.size");
  tooltip(wand ? "Distance of points from the plane   [ ]\nScroll over a "
                 "view while a plane is shown; Ctrl+scroll zooms"
               : "Brush radius   [ ]\nScroll over a view; Ctrl+scroll "
                 "zooms");
  ImGui::SameLine(0, ui.px(5));
  ImGui::TextDisabled("%s", text.c_str());
  ImGui::SameLine(0, 0);  // keeps the next item in place
  ImGui::Dummy(ImVec2(std::max(0.0f, number - ImGui::CalcTextSize(text.c_str()).x), 0));
}

}  // namespace

void draw_label_tools(const Ui& ui) {
  draw_tool_buttons(ui);
  draw_paint(ui);
  draw_size(ui);
  static constexpr const char* kSwitches[][2] = {
      {"label.ignore", "ignore"}, {"label.erase", "erase"}, {"label.through", "through"}};
  float gap = 14;
  for (const auto& [action, label] : kSwitches) {
    if (!same_line_if_room(button_width(label), ui.px(gap))) return;
    action_button(ui, action, label);
    gap = 3;
  }
}

// ---- 3D view ------------------------------------------------------------------------------------

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

/// Always shows whether strokes include hidden points.
void draw_through_badge(const Ui& ui, const DrawingSurface& surface) {
  const LabelView& view = ui.state.view.label;
  std::string text = view.through ? "through" : "visible only";
  if (view.hover_hidden > 0)
    text += fmt::format("   {} hidden {}", view.hover_hidden, view.through ? "taken" : "left");
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

// ---- Image view ---------------------------------------------------------------------------------

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
