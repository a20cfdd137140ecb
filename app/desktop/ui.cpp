#include "app/desktop/ui.hpp"

#include <fmt/format.h>

#include <cmath>

#include "render/palette.hpp"

namespace planescope::desktop {

void Ui::name(const std::string& widget) const {
  name(widget, ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
}

void Ui::name(const std::string& widget, ImVec2 min, ImVec2 max) const {
  widgets[widget] = {min, max};
}

ImU32 to_imgui(render::Rgba color) { return IM_COL32(color.r, color.g, color.b, color.a); }

void case_badge(const Ui& ui, planes::Case c) {
  const float height = ImGui::GetTextLineHeight();
  const ImVec2 size(height * 1.5f, height);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), to_imgui(render::case_color(c)),
                      ui.px(3));
  const char* text = planes::to_string(c);
  const ImVec2 extent = ImGui::CalcTextSize(text);
  const render::Rgba fill = render::case_color(c);
  const bool light = 0.299 * fill.r + 0.587 * fill.g + 0.114 * fill.b > 140;
  draw->AddText(ImVec2(at.x + (size.x - extent.x) / 2, at.y + (size.y - extent.y) / 2),
                light ? IM_COL32(20, 22, 26, 255) : IM_COL32(255, 255, 255, 255), text);
  ImGui::Dummy(size);
}

std::string number_text(double value) {
  if (!std::isfinite(value)) return std::isnan(value) ? "–" : value > 0 ? "∞" : "-∞";
  if (value == std::floor(value) && std::abs(value) < 1e6) return fmt::format("{:.0f}", value);
  return fmt::format("{:.4g}", value);
}

std::string length_text_cm(double metres) {
  return std::abs(metres) < 0.01 ? fmt::format("{:.3g} mm", 1000 * metres)
         : std::abs(metres) < 1  ? fmt::format("{:.3g} cm", 100 * metres)
                                 : fmt::format("{:.3g} m", metres);
}

}  // namespace planescope::desktop
