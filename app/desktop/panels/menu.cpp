#include <algorithm>
#include <map>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

/// Actions of a group stand together: mostly by what their names begin with.
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
  // In the order in which the table first names each menu.
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

}  // namespace planescope::desktop
