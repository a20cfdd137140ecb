#include "app/desktop/check_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planescope::desktop {
namespace {

/// To the right of the middle: passes; its length is the margin, at most all of the threshold.
void draw_margin(const Ui& ui, const Check& check) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = std::max(ui.px(24), ImGui::GetContentRegionAvail().x);
  const float height = ImGui::GetTextLineHeight();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float middle = at.x + width / 2;
  draw->AddLine(ImVec2(middle, at.y), ImVec2(middle, at.y + height), ui.colors.grid);
  if (check.verdict != Verdict::not_asked && std::isfinite(check.margin)) {
    const float reach = static_cast<float>(std::clamp(check.margin, -1.0, 1.0)) * width / 2;
    const float x0 = std::min(middle, middle + reach), x1 = std::max(middle, middle + reach);
    draw->AddRectFilled(ImVec2(x0, at.y + height * 0.25f),
                        ImVec2(std::max(x1, x0 + ui.px(2)), at.y + height * 0.8f),
                        check.verdict == Verdict::pass ? ui.colors.good : ui.colors.bad);
  }
  ImGui::Dummy(ImVec2(width, height));
}

/// "e_n = 0.00712 ≤ 0.005 m²": three digits, the unit once.
std::string comparison_text(const Check& check) {
  const bool metres = check.unit == "m";
  const auto text = [&](double value) {
    if (!std::isfinite(value) || value == std::floor(value)) return number_text(value);
    return fmt::format("{:.3g}", metres ? 1000 * value : value);
  };
  std::string unit = check.unit == "points" || check.unit.empty() ? "" : " " + check.unit;
  if (metres) unit = " mm";
  if (check.unit == "deg") unit = "°";
  if (check.op.empty()) return fmt::format("{} = {}{}", check.quantity, text(check.value), unit);
  return fmt::format("{} = {} {} {}{}", check.quantity, text(check.value), check.op,
                     text(check.threshold), unit);
}

}  // namespace

void draw_checks(const Ui& ui, const std::string& name, const std::vector<Check>& checks) {
  if (!ImGui::BeginTable(("##checks." + name).c_str(), 4,
                         ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH))
    return;
  ImGui::TableSetupColumn("criterion", ImGuiTableColumnFlags_WidthStretch, 1.1f);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 2.6f);
  ImGui::TableSetupColumn("verdict", ImGuiTableColumnFlags_WidthFixed, ui.px(32));
  ImGui::TableSetupColumn("margin", ImGuiTableColumnFlags_WidthFixed, ui.px(48));
  std::string criterion;
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const Check& check = checks[i];
    const bool asked = check.verdict != Verdict::not_asked;
    ImGui::PushStyleColor(ImGuiCol_Text, asked ? ui.colors.text : ui.colors.muted);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const std::string label = check.criterion == criterion ? "" : check.criterion;
    criterion = check.criterion;
    const std::string widget = fmt::format("check.{}.{}", name, i);
    if (ImGui::Selectable(fmt::format("{}##{}", label, widget).c_str(), false,
                          ImGuiSelectableFlags_SpanAllColumns) &&
        !check.option.empty())
      ui.emit("option.show", check.option);
    ui.name(widget);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip(
          "%s, %s\n%s: %s%s", check.criterion.c_str(), check.equation.c_str(),
          check.quantity.c_str(), check.meaning.c_str(),
          check.option.empty()
              ? ""
              : ("\nthreshold: option " + check.option + ", click for its slider").c_str());
    if (!label.empty()) {
      ImGui::PushFont(ui.small);
      ImGui::TextDisabled("%s", check.equation.c_str());
      ImGui::PopFont();
    }
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(comparison_text(check).c_str());
    ImGui::TableNextColumn();
    if (!check.op.empty()) {
      const char* verdict = !asked ? "not asked" : check.verdict == Verdict::pass ? "pass" : "fail";
      ImGui::PushStyleColor(ImGuiCol_Text, !asked                           ? ui.colors.muted
                                           : check.verdict == Verdict::pass ? ui.colors.good
                                                                            : ui.colors.bad);
      ImGui::TextUnformatted(asked ? verdict : "–");
      ImGui::PopStyleColor();
    }
    ImGui::TableNextColumn();
    if (!check.op.empty()) draw_margin(ui, check);
    ImGui::PopStyleColor();
  }
  ImGui::EndTable();
}

}  // namespace planescope::desktop
