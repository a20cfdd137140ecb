#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/panels.hpp"
#include "app/desktop/ui.hpp"

namespace planescope::desktop {
namespace {

constexpr int kMostShown = 14;

/// "Ctrl+Shift+Z / Ctrl+Y": all keys of an action.
std::string keys_text(const Action& action) {
  std::string text;
  for (const char c : action.keys) text += c == ' ' ? std::string(" / ") : std::string(1, c);
  return text;
}

void close(const Ui& ui) {
  ui.memory.palette_text.clear();
  ui.memory.palette_index = 0;
  ui.emit("palette");
}

/// The argument of one action, typed: a path, most of the time.
void draw_question(const Ui& ui, const Action& action, bool entered) {
  ImGui::TextDisabled(
      action.takes == "PATH" ? "a path, and Enter; Esc leaves" : "%s, and Enter; Esc leaves",
      action.takes.c_str());
  if (!entered || ui.memory.palette_text.empty()) return;
  ui.emit(action.name, ui.memory.palette_text);
  close(ui);
}

}  // namespace

void draw_palette(const Ui& ui) {
  PanelMemory& memory = ui.memory;
  const ImGuiIO& io = ImGui::GetIO();
  const float width = std::min(ui.px(560), io.DisplaySize.x - ui.px(40));
  ImGui::SetNextWindowPos(ImVec2((io.DisplaySize.x - width) / 2, ui.px(60)));
  ImGui::SetNextWindowSize(ImVec2(width, 0));
  ImGui::Begin("##palette", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings);
  if (ImGui::IsWindowAppearing()) {
    ImGui::SetWindowFocus();
    memory.palette_text.clear();
    memory.palette_index = 0;
  }
  const std::string& asks = ui.state.view.palette_asks;
  const Action* asked = asks.empty() ? nullptr : &find_action(asks);
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::IsAnyItemActive()) ImGui::SetKeyboardFocusHere();
  const std::string before = memory.palette_text;
  const bool entered = ImGui::InputTextWithHint(
      "##typed", asked ? asked->title.c_str() : "find an action: step, filter, camera, theme …",
      &memory.palette_text, ImGuiInputTextFlags_EnterReturnsTrue);
  ui.name("palette.text");
  // While one types, Escape belongs to the text box and triggers no action.
  if (ImGui::IsItemDeactivated() && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)))
    close(ui);
  if (asked) {
    draw_question(ui, *asked, entered);
    ImGui::End();
    return;
  }
  if (memory.palette_text != before) memory.palette_index = 0;
  const std::vector<const Action*> found =
      matching_actions(memory.palette_text, ui.state.view.mode);
  const int shown = std::min(kMostShown, static_cast<int>(found.size()));
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_DownArrow))) ++memory.palette_index;
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_UpArrow))) --memory.palette_index;
  memory.palette_index = std::clamp(memory.palette_index, 0, std::max(0, shown - 1));
  const Action* chosen = nullptr;
  for (int i = 0; i < shown; ++i) {
    const Action& action = *found[static_cast<std::size_t>(i)];
    const ImU32 color = action.can_run(ui.state) ? ui.colors.text : ui.colors.muted;
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    if (ImGui::Selectable((action.title + "##" + action.name).c_str(), i == memory.palette_index))
      chosen = &action;
    ui.name("palette." + action.name);
    ImGui::PopStyleColor();
    const std::string keys = keys_text(action);
    ImGui::SameLine(width - ImGui::CalcTextSize(keys.c_str()).x - ui.px(14));
    ImGui::TextDisabled("%s", keys.c_str());
  }
  if (found.empty()) ImGui::TextDisabled("No action has such a name.");
  if (entered && shown > 0) chosen = found[static_cast<std::size_t>(memory.palette_index)];
  if (chosen) {
    close(ui);
    ui.emit(chosen->name);  // what needs an argument opens the palette again and asks
  }
  ImGui::End();
}

}  // namespace planescope::desktop
