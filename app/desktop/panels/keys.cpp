#include <algorithm>

#include "app/desktop/panels.hpp"

namespace planescope::desktop {

void draw_keys(const Ui& ui) {
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 size(std::min(ui.px(1080), io.DisplaySize.x - ui.px(40)),
                    std::min(ui.px(640), io.DisplaySize.y - ui.px(80)));
  ImGui::SetNextWindowPos(ImVec2((io.DisplaySize.x - size.x) / 2, (io.DisplaySize.y - size.y) / 2));
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("##keys", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings);
  if (ImGui::IsWindowAppearing()) ImGui::SetWindowFocus();
  ImGui::PushFont(ui.bold);
  ImGui::TextUnformatted("Keys");
  ImGui::PopFont();
  ImGui::SameLine();
  ImGui::TextDisabled("Esc or ? closes this; Ctrl+P finds an action by name");
  std::vector<std::string> menus;
  for (const Action& action : action_table())
    if (!action.keys.empty() && std::find(menus.begin(), menus.end(), action.menu) == menus.end())
      menus.push_back(action.menu);
  if (ImGui::BeginTable("##columns", 3)) {
    // Menus from top to bottom, in columns of about the same length.
    std::size_t rows = 0;
    for (const Action& action : action_table()) rows += action.keys.empty() ? 0 : 1;
    const std::size_t per_column = (rows + 2 * menus.size() + 2) / 3;
    std::size_t used = 0;
    ImGui::TableNextColumn();
    for (const std::string& menu : menus) {
      const auto in_menu = [&](const Action& a) { return a.menu == menu && !a.keys.empty(); };
      const auto count = static_cast<std::size_t>(
          std::count_if(action_table().begin(), action_table().end(), in_menu));
      if (used > 0 && used + count / 2 > per_column) {
        ImGui::TableNextColumn();
        used = 0;
      }
      used += count + 2;
      ImGui::Spacing();
      ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(ui.colors.accent), "%s", menu.c_str());
      for (const Action& action : action_table()) {
        if (!in_menu(action)) continue;
        ImGui::TextDisabled("%s", action.keys.c_str());
        ImGui::SameLine(ui.px(120));  // of the column
        ImGui::TextUnformatted(action.title.c_str());
      }
    }
    ImGui::EndTable();
  }
  ui.name("keys", ImGui::GetWindowPos(),
          ImVec2(ImGui::GetWindowPos().x + size.x, ImGui::GetWindowPos().y + size.y));
  ImGui::End();
}

}  // namespace planescope::desktop
