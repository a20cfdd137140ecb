#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/desktop/imgui.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

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

/// Of a folder that cannot be read there is nothing.
std::vector<std::string> completed_paths(const std::string& typed) {
  namespace fs = std::filesystem;
  constexpr std::size_t kMost = 8;
  const std::size_t slash = typed.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : typed.substr(0, slash + 1);
  const std::string begin = typed.substr(folder.size());
  std::vector<std::string> found;
  std::error_code failed;
  for (fs::directory_iterator it(folder.empty() ? "." : folder, failed), end; !failed && it != end;
       it.increment(failed)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with(begin) || (name[0] == '.' && begin.empty())) continue;
    std::error_code gone;
    found.push_back(folder + name + (it->is_directory(gone) ? "/" : ""));
  }
  std::sort(found.begin(), found.end());
  if (found.size() > kMost) found.resize(kMost);
  return found;
}

/// What there is that begins with what was typed; a click, or Tab where it is the first, takes it.
void draw_paths(const Ui& ui) {
  std::string& text = ui.memory.palette_text;
  const std::vector<std::string> found = completed_paths(text);
  const bool tab = went_down(ImGuiKey_Tab);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool clicked = ImGui::Selectable((found[i] + "##path").c_str(), i == 0);
    ui.name(fmt::format("palette.path.{}", i));
    if (!clicked && !(tab && i == 0)) continue;
    text = found[i];
    ImGui::ClearActiveID();  // the box takes the text anew, and the keyboard in the next frame
  }
}

/// Recordings that were Recent, dim where they are no longer there.
void draw_recent(const Ui& ui) {
  const std::vector<std::filesystem::path>& recent = ui.state.document.recent;
  if (!recent.empty()) ImGui::TextDisabled("Recent");
  for (std::size_t i = 0; i < recent.size(); ++i) {
    std::error_code gone;
    const bool there = std::filesystem::exists(recent[i], gone);
    ImGui::PushStyleColor(ImGuiCol_Text, there ? ui.colors.text : ui.colors.muted);
    const std::string text = recent[i].string() + (there ? "" : "   (missing)");
    if (ImGui::Selectable((text + "##recent").c_str()))
      ui.emit("recording.open", recent[i].string());
    ImGui::PopStyleColor();
    ui.name(fmt::format("palette.recent.{}", i));
  }
}

/// The argument of one action, typed: a path, most of the time.
void draw_question(const Ui& ui, const Action& action, bool entered) {
  ImGui::TextDisabled(
      action.takes == "PATH" ? "Path, then Enter; Esc cancels" : "%s, then Enter; Esc cancels",
      action.takes.c_str());
  const ViewState& view = ui.state.view;
  if (view.message_is_error && !view.message.empty()) {
    paragraph(ui.colors.bad, view.message);
    ui.name("palette.problem");
  }
  if (action.name == "recording.open" && ui.memory.palette_text.empty())
    draw_recent(ui);
  else if (action.takes.starts_with("PATH"))
    draw_paths(ui);
  // It closes once the action could take that.
  if (entered && !ui.memory.palette_text.empty()) ui.emit(action.name, ui.memory.palette_text);
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
      "##typed", asked ? asked->title.c_str() : "Find an action: step, filter, camera, theme …",
      &memory.palette_text, ImGuiInputTextFlags_EnterReturnsTrue);
  ui.name("palette.text");
  // While one types, Escape belongs to the text box and triggers no action.
  if (ImGui::IsItemDeactivated() && went_down(ImGuiKey_Escape)) close(ui);
  if (asked) {
    draw_question(ui, *asked, entered);
    ImGui::End();
    return;
  }
  if (memory.palette_text != before) memory.palette_index = 0;
  const std::vector<Offer> found = palette_offers(ui.state, memory.palette_text);
  const int shown = std::min(kMostShown, static_cast<int>(found.size()));
  if (went_down(ImGuiKey_DownArrow)) ++memory.palette_index;
  if (went_down(ImGuiKey_UpArrow)) --memory.palette_index;
  memory.palette_index = std::clamp(memory.palette_index, 0, std::max(0, shown - 1));
  const Offer* chosen = nullptr;
  for (int i = 0; i < shown; ++i) {
    const Offer& offer = found[static_cast<std::size_t>(i)];
    const Action& action = *offer.action;
    const std::string name = action.name + (offer.argument.empty() ? "" : "." + offer.argument);
    std::error_code gone;
    const bool there = offer.argument.empty() || std::filesystem::exists(offer.argument, gone);
    const ImU32 color = action.can_run(ui.state) && there ? ui.colors.text : ui.colors.muted;
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    if (ImGui::Selectable((offer.title + "##" + name).c_str(), i == memory.palette_index))
      chosen = &offer;
    ui.name("palette." + name);
    ImGui::PopStyleColor();
    if (!offer.argument.empty()) {
      tooltip(offer.argument);
      continue;
    }
    const std::string keys = keys_text(action);
    ImGui::SameLine(width - ImGui::CalcTextSize(keys.c_str()).x - ui.px(14));
    ImGui::TextDisabled("%s", keys.c_str());
  }
  if (found.empty()) ImGui::TextDisabled("No matching action");
  if (entered && shown > 0) chosen = &found[static_cast<std::size_t>(memory.palette_index)];
  if (chosen) {
    close(ui);
    ui.emit(chosen->action->name,
            chosen->argument);  // what needs an argument opens the palette again and asks
  }
  ImGui::End();
}

}  // namespace planescope::desktop
