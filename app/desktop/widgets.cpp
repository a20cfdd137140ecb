#include "app/desktop/widgets.hpp"

namespace planescope::desktop {

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
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

bool button(const Ui& ui, const std::string& text, const std::string& widget, bool enabled) {
  ImGui::BeginDisabled(!enabled);
  const bool clicked = ImGui::Button((text + "###" + widget).c_str());
  ImGui::EndDisabled();
  ui.name(widget);
  return clicked;
}

}  // namespace planescope::desktop
