// The bar above both views: tools, the active plane, sizes. What finds no room is in the menus,
// too.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/labeling/work.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/labels/edit/operations.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
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

/// What the next gesture paints: a swatch with its name.
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
      "What the next gesture paints\n1 to 9 and Tab choose a plane, N a new one, P the one under "
      "the mouse\nI paints \"do not score\", 0 erases");
}

/// The brush's radius or the wand's tolerance.
void draw_size(const Ui& ui) {
  const LabelView& view = ui.state.view.label;
  const bool wand = view.tool == LabelTool::wand;
  if (!wand && view.tool != LabelTool::brush) return;
  auto value = static_cast<float>(wand ? 1000 * view.wand_options.tolerance_m : view.brush_px);
  const std::string text = wand ? fmt::format("{:.1f} mm", value) : fmt::format("{:.0f} px", value);
  const float slider = ui.px(80), number = ImGui::CalcTextSize("88.8 mm").x;
  if (!same_line_if_room(slider + number, ui.px(14))) return;
  // The number stands beside the slider: on it, the grab would hide it.
  ImGui::SetNextItemWidth(slider);
  if (ImGui::SliderFloat("##size", &value, 1, wand ? 40 : 100, "",
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp)) {
    if (wand)
      ui.emit("label.wand.tolerance", fmt::format("{:.6g}", value / 1000));
    else
      ui.emit("label.brush", fmt::format("{:.6g}", value));
  }
  ui.name("label.size");
  tooltip(wand ? "Distance of points from the plane   [ ]\nScroll over a "
                 "view while a plane is shown; Ctrl+scroll zooms"
               : "Brush radius   [ ]\nScroll over a view; Ctrl+scroll "
                 "zooms");
  ImGui::SameLine(0, ui.px(5));
  ImGui::TextDisabled("%s", text.c_str());
  ImGui::SameLine(0, 0);  // what follows keeps its place
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

}  // namespace planescope::desktop
