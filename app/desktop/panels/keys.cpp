// The key sheet: every key by the menu of its action, and what the mouse does.

#include <algorithm>
#include <span>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

constexpr std::size_t kColumns = 3;

struct Gesture {
  const char* mouse;
  const char* does;
};
constexpr Gesture kDebuggerMouse[] = {{"click", "select"},
                                      {"double-click", "frame it"},
                                      {"drag in the scene", "orbit"},
                                      {"right or Shift drag", "pan"},
                                      {"scroll", "zoom"},
                                      {"drag in the image", "pan; mark after M"},
                                      {"drag over bars", "filter events"},
                                      {"scroll, right drag on the timeline", "zoom, pan"},
                                      {"drag a splitter", "resize panels"}};
constexpr Gesture kLabelMouse[] = {{"click, drag", "use the tool"},
                                   {"Shift drag", "only on unlabeled pixels"},
                                   {"Alt or Ctrl drag", "remove; with the wand, a lasso"},
                                   {"right drag", "orbit the scene, pan the image"},
                                   {"middle or Shift right drag", "pan"},
                                   {"scroll", "zoom; size of the tool (Ctrl: always zoom)"},
                                   {"double-click a plane", "frame it"}};
std::span<const Gesture> gestures(Mode mode) {
  if (mode == Mode::labels) return kLabelMouse;
  return kDebuggerMouse;
}

/// In lines of as many as there is room for.
void draw_gestures(const Ui& ui) {
  colored(ui.colors.accent, "Mouse");
  ui.name("keys.mouse");
  bool first = true;
  for (const auto& [mouse, does] : gestures(ui.state.view.mode)) {
    const std::string text = std::string(mouse) + ": " + does;
    if (!first) same_line_if_room(ImGui::CalcTextSize(text.c_str()).x, ui.px(18));
    first = false;
    ImGui::TextUnformatted((std::string(mouse) + ":").c_str());
    ImGui::SameLine(0, ui.px(4));
    ImGui::TextDisabled("%s", does);
  }
}

/// The first of its keys that means this action and no other here; empty where none does.
std::string key_here(const Action& action, Mode mode) {
  if (action.key_is_argument) {
    const std::string& keys = action.keys;
    return keys.substr(0, keys.find(' ')) + " to " + keys.substr(keys.rfind(' ') + 1);
  }
  for (const std::string& key : split(action.keys, ' '))
    if (action_of_key(key, mode) == &action) return key;
  return "";
}

struct Section {
  std::string menu;
  std::vector<const Action*> actions;
};
using Column = std::vector<Section>;

std::vector<Section> sections(Mode mode) {
  std::vector<Section> all;
  for (const Action& action : action_table()) {
    if (action.keys.empty() || !fits(action, mode) || key_here(action, mode).empty()) continue;
    const auto same = [&](const Section& section) { return section.menu == action.menu; };
    auto section = std::find_if(all.begin(), all.end(), same);
    if (section == all.end()) section = all.insert(all.end(), {action.menu, {}});
    section->actions.push_back(&action);
  }
  return all;
}

std::size_t lines_of(const Column& column) {
  std::size_t lines = 0;
  for (const Section& section : column) lines += section.actions.size() + 2;
  return lines;
}

/// Menus from top to bottom, in columns of about the same length.
std::vector<Column> columns(Mode mode) {
  std::vector<Section> all = sections(mode);
  const std::size_t each = lines_of(all) / kColumns;
  std::vector<Column> columns(1);
  for (Section& section : all) {
    const std::size_t used = lines_of(columns.back());
    if (used > 0 && used + section.actions.size() / 2 > each && columns.size() < kColumns)
      columns.emplace_back();
    columns.back().push_back(std::move(section));
  }
  return columns;
}

/// The width of the widest text of a column's actions.
template <typename TextOf>
float widest(const Column& column, const TextOf& text_of) {
  float width = 0;
  for (const Section& section : column)
    for (const Action* action : section.actions)
      width = std::max(width, ImGui::CalcTextSize(text_of(*action).c_str()).x);
  return width;
}

void draw_column(const Ui& ui, const Column& column, float title_at) {
  for (const Section& section : column) {
    colored(ui.colors.accent, section.menu);
    for (const Action* action : section.actions) {
      ImGui::TextUnformatted(key_here(*action, ui.state.view.mode).c_str());
      ui.name("keys." + action->name);
      ImGui::SameLine(title_at);  // from the group's left
      ImGui::TextDisabled("%s", action->title.c_str());
    }
    ImGui::Dummy(ImVec2(1, ui.px(4)));
  }
}

}  // namespace

void draw_keys(const Ui& ui) {
  const std::vector<Column> all = columns(ui.state.view.mode);
  const float gap = ui.px(10), between = ui.px(14), line = ImGui::GetTextLineHeightWithSpacing();
  std::vector<float> titles_at, widths;
  ImVec2 size(2 * ui.px(12), 0);
  for (const Column& column : all) {
    titles_at.push_back(
        gap + widest(column, [&](const Action& a) { return key_here(a, ui.state.view.mode); }));
    widths.push_back(titles_at.back() + widest(column, [](const Action& a) { return a.title; }));
    size.x += widths.back() + (widths.size() > 1 ? between : 0);
    size.y = std::max(size.y, line * static_cast<float>(lines_of(column)));
  }
  size.y += 6 * line;
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  if (size.y > display.y - ui.px(40)) size.x += ImGui::GetStyle().ScrollbarSize;
  size = ImVec2(std::min(size.x, display.x - ui.px(20)), std::min(size.y, display.y - ui.px(40)));
  ImGui::SetNextWindowPos(ImVec2((display.x - size.x) / 2, (display.y - size.y) / 2));
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(ui.px(12), ui.px(10)));
  ImGui::Begin("##keys", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_HorizontalScrollbar);
  if (ImGui::IsWindowAppearing()) ImGui::SetWindowFocus();
  heading(ui, "Keys");
  ImGui::SameLine();
  ImGui::TextDisabled("Esc or ? closes this; Ctrl+P finds actions");
  ImGui::Spacing();
  draw_gestures(ui);
  ImGui::Spacing();
  ImVec2 at = ImGui::GetCursorPos();
  for (std::size_t i = 0; i < all.size(); ++i) {
    ImGui::SetCursorPos(at);
    ImGui::BeginGroup();
    draw_column(ui, all[i], titles_at[i]);
    ImGui::EndGroup();
    at.x += widths[i] + between;
  }
  const ImVec2 from = ImGui::GetWindowPos();
  ui.name("keys", from, ImVec2(from.x + size.x, from.y + size.y));
  ImGui::End();
  ImGui::PopStyleVar();
}

}  // namespace planescope::desktop
