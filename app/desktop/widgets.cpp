#include "app/desktop/widgets.hpp"

#include <algorithm>

#include "app/desktop/math_text.hpp"

namespace planescope::desktop {

bool was_dragged() {
  constexpr float kClickSlack_px = 4;
  return ImGui::GetIO().MouseDragMaxDistanceSqr[0] > kClickSlack_px * kClickSlack_px;
}
namespace {

/// Lines broken at spaces only: ImGui would also part "9." from "15".
std::string wrapped(const std::string& text, float width) {
  std::string lines;
  std::size_t line = 0;  // where the last one begins in `lines`
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::string longer = lines.substr(line) + (lines.size() > line ? " " : "") + word;
    if (lines.size() > line && ImGui::CalcTextSize(longer.c_str()).x > width) {
      lines += '\n';
      line = lines.size();
      lines += word;
    } else {
      lines.replace(line, std::string::npos, longer);
    }
    begin = end + 1;
  }
  return lines;
}

}  // namespace

bool link(const Ui& ui, const std::string& text, const std::string& widget) {
  paragraph(ui.colors.accent, text);
  ui.name(widget);
  if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
  return ImGui::IsItemClicked();
}

void heading(const Ui& ui, const std::string& text) {
  ImGui::PushFont(ui.bold);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopFont();
}

void paragraph(ImU32 color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::PushTextWrapPos(0);
  // What is wider than the room without a space, such as a path, is left to ImGui.
  ImGui::TextUnformatted(wrapped(text, ImGui::GetContentRegionAvail().x).c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

void math_paragraph(const Ui& ui, ImU32 color, const std::string& text) {
  const std::string lines = wrapped(text, ImGui::GetContentRegionAvail().x);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(ImGui::GetStyle().ItemSpacing.x, 0));
  ImGui::BeginGroup();
  for (std::size_t begin = 0; begin < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', begin), lines.size());
    math_text(ui, color, lines.substr(begin, end - begin));
    begin = end + 1;
  }
  ImGui::EndGroup();
  ImGui::PopStyleVar();
}

bool button(const Ui& ui, const std::string& text, const std::string& widget, bool enabled) {
  ImGui::BeginDisabled(!enabled);
  const bool clicked = ImGui::Button((text + "###" + widget).c_str());
  ImGui::EndDisabled();
  ui.name(widget);
  return clicked;
}

void same_line_if_fits(const std::string& text) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float width = ImGui::CalcTextSize(text.c_str()).x + 2 * style.FramePadding.x;
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  if (ImGui::GetItemRectMax().x + style.ItemSpacing.x + width <= right) ImGui::SameLine();
}

std::string keys_text(const Action& action) {
  std::string text;
  for (const char c : action.keys) text += c == ' ' ? std::string(" / ") : std::string(1, c);
  return text;
}

}  // namespace planescope::desktop
