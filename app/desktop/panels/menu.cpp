// Lists of actions: the menu bar, the palette and the key sheet.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <span>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {

// ---- Menu bar -----------------------------------------------------------------------------------

namespace {

/// Group of an action within a menu, mostly the prefix of its name.
std::string group_of(const Action& action) {
  static const std::map<std::string, std::string> also = {
      {"image", "show"},   {"compare", "run"},   {"point", "select"}, {"zoom", "theme"},
      {"layout", "theme"}, {"palette", "theme"}, {"keys", "theme"},   {"timing", "theme"}};
  const std::string name = action.name.substr(0, action.name.find('.'));
  const auto with = also.find(name);
  return with == also.end() ? name : with->second;
}

}  // namespace

void draw_menu(const Ui& ui) {
  // Menus in order of their first appearance in the table.
  std::vector<std::string> menus;
  for (const Action& action : action_table())
    if (!action.menu.empty() && fits(action, ui.state.view.mode) &&
        std::find(menus.begin(), menus.end(), action.menu) == menus.end())
      menus.push_back(action.menu);
  const bool wanted = ui.state.view.keyboard == kMenuPanel;
  if (wanted && ui.memory.texts["keyboard"] != kMenuPanel) {
    ImGui::OpenPopup(menus.front().c_str());
    ui.memory.texts["keyboard"] = kMenuPanel;
  }
  for (const std::string& menu : menus) {
    const bool open = ImGui::BeginMenu(menu.c_str());
    ui.name("menu." + menu);
    if (!open) continue;
    std::string group;
    for (const Action& action : action_table()) {
      if (action.menu != menu || !fits(action, ui.state.view.mode)) continue;
      if (!group.empty() && group != group_of(action)) ImGui::Separator();
      group = group_of(action);
      action_item(ui, action, "menu");
    }
    ImGui::EndMenu();
  }
}

// ---- Palette ------------------------------------------------------------------------------------

namespace {

constexpr int kMostShown = 14;

/// All keys of an action: "Ctrl+Shift+Z / Ctrl+Y".
std::string keys_text(const Action& action) {
  std::string text;
  for (const char c : action.keys) text += c == ' ' ? std::string(" / ") : std::string(1, c);
  return text;
}

void close(const Ui& ui) {
  ui.memory.palette_text.clear();
  ui.memory.palette_index = 0;
  ui.act("palette");
}

/// Returns nothing for unreadable folders.
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

/// Lists existing paths that begin with the typed text. Click to insert one; Tab inserts the first.
void draw_paths(const Ui& ui) {
  std::string& text = ui.memory.palette_text;
  const std::vector<std::string> found = completed_paths(text);
  const bool tab = went_down(ImGuiKey_Tab);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool clicked = ImGui::Selectable((found[i] + "##path").c_str(), i == 0);
    ui.name(fmt::format("palette.path.{}", i));
    if (!clicked && !(tab && i == 0)) continue;
    text = found[i];
    ImGui::ClearActiveID();  // makes the box reload its text
  }
}

/// Lists recent recordings; missing ones are dimmed.
void draw_recent(const Ui& ui) {
  const std::vector<std::filesystem::path>& recent = ui.state.document.recent;
  if (!recent.empty()) ImGui::TextDisabled("Recent");
  for (std::size_t i = 0; i < recent.size(); ++i) {
    std::error_code gone;
    const bool there = std::filesystem::exists(recent[i], gone);
    ImGui::PushStyleColor(ImGuiCol_Text, there ? ui.colors.text : ui.colors.muted);
    const std::string text = recent[i].string() + (there ? "" : "   (missing)");
    if (ImGui::Selectable((text + "##recent").c_str()))
      ui.act("recording.open", recent[i].string());
    ImGui::PopStyleColor();
    ui.name(fmt::format("palette.recent.{}", i));
  }
}

/// Asks for the argument of an action, usually a path.
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
  // The palette closes once the action accepts the argument.
  if (entered && !ui.memory.palette_text.empty())
    ui.commands.push_back({action.name, ui.memory.palette_text});
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
  // While typing, Escape belongs to the text box and triggers no action.
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
    // An action with an argument opens the palette again to ask for it.
    ui.commands.push_back({chosen->action->name, chosen->argument});
  }
  ImGui::End();
}

// ---- Key sheet ----------------------------------------------------------------------------------

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

/// Wraps gestures to the available width.
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

/// The first key that triggers this action and no other in this mode; empty if there is none.
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

/// Distributes menus over columns of about equal length.
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

/// Width of the widest text in a column.
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
      ImGui::SameLine(title_at);  // relative to the group's left
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
