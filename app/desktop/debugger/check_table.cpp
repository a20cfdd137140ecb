#include "app/desktop/debugger/check_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/math_text.hpp"

namespace planescope::desktop {
namespace {

/// To the right of the middle: passes; its length is the margin, at most all of the threshold.
void draw_margin(const Ui& ui, const debug::Check& check) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = std::max(ui.px(24), ImGui::GetContentRegionAvail().x);
  const float height = ImGui::GetTextLineHeight();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float middle = at.x + width / 2;
  draw->AddLine(ImVec2(middle, at.y), ImVec2(middle, at.y + height), ui.colors.grid);
  if (check.verdict != debug::Verdict::not_asked && std::isfinite(check.margin)) {
    const float reach = static_cast<float>(std::clamp(check.margin, -1.0, 1.0)) * width / 2;
    const float x0 = std::min(middle, middle + reach), x1 = std::max(middle, middle + reach);
    draw->AddRectFilled(ImVec2(x0, at.y + height * 0.25f),
                        ImVec2(std::max(x1, x0 + ui.px(2)), at.y + height * 0.8f),
                        check.verdict == debug::Verdict::pass ? ui.colors.good : ui.colors.bad);
  }
  ImGui::Dummy(ImVec2(width, height));
}

/// "e_n" and "0.00712 ≤ 0.005 m²": three digits, the unit once. What was never computed is asked
/// without a value.
struct Comparison {
  std::string quantity, rest;
};

Comparison comparison_of(const debug::Check& check) {
  const bool millimetres = check.unit == "m" && check.threshold < 1;
  const auto text = [&](double value) {
    if (!std::isfinite(value) || value == std::floor(value)) return number_text(value);
    return fmt::format("{:.3g}", millimetres ? 1000 * value : value);
  };
  std::string unit = check.unit == "points" || check.unit.empty() ? "" : " " + check.unit;
  if (millimetres) unit = " mm";
  if (check.unit == "deg") unit = "°";
  const bool valued = check.verdict != debug::Verdict::not_asked || std::isfinite(check.value);
  const std::string value = valued ? "= " + text(check.value) : "";
  if (check.op.empty()) return {check.quantity, valued ? value + unit : ""};
  return {check.quantity, fmt::format("{}{}{} {}{}", value, valued ? " " : "", check.op,
                                      text(check.threshold), unit)};
}

/// In one line where there is room, otherwise the numbers stand below.
void draw_comparison(const Ui& ui, const debug::Check& check, ImU32 color) {
  const Comparison comparison = comparison_of(check);
  const std::string line = comparison.quantity + " " + comparison.rest;
  if (math_width(ui, line) <= ImGui::GetContentRegionAvail().x) return math_text(ui, color, line);
  math_text(ui, color, comparison.quantity);
  math_text(ui, color, comparison.rest);
}

const char* word_of(debug::Verdict verdict) {
  return verdict == debug::Verdict::pass ? "pass" : verdict == debug::Verdict::fail ? "fail" : "–";
}

void draw_tooltip(const debug::Check& check) {
  std::string text =
      fmt::format("{}, {}\n{}: {}", check.criterion, check.equation, check.quantity, check.meaning);
  if (check.verdict == debug::Verdict::not_asked && !check.op.empty())
    text += "\nnot asked: an earlier criterion had decided";
  if (!check.option.empty())
    text += "\nthreshold: option " + check.option + ", click for its slider";
  ImGui::SetTooltip("%s", text.c_str());
}

/// Where a row's criterion and its equation are told.
struct Name {
  std::string criterion, equation;
  bool beside = false;  // the equation stands beside the criterion, not in its place
};

/// A criterion of several rows has its equation in the second one; one of a single row beside its
/// name, where the panel is wide enough for that.
std::vector<Name> names_of(const std::vector<debug::Check>& checks, bool wide) {
  std::vector<Name> names(checks.size());
  for (std::size_t begin = 0, end = 0; begin < checks.size(); begin = end) {
    while (end < checks.size() && checks[end].criterion == checks[begin].criterion) ++end;
    names[begin].criterion = checks[begin].criterion;
    names[begin].beside = wide && end == begin + 1;
    if (names[begin].beside) names[begin].equation = checks[begin].equation;
    if (end > begin + 1) names[begin + 1].equation = checks[begin + 1].equation;
  }
  return names;
}

float width_of(const Ui& ui, const Name& name) {
  const float criterion = ImGui::CalcTextSize(name.criterion.c_str()).x;
  ImGui::PushFont(ui.small);
  const float equation = ImGui::CalcTextSize(name.equation.c_str()).x;
  ImGui::PopFont();
  return name.beside ? criterion + ui.px(6) + equation : std::max(criterion, equation);
}

/// In a row that takes the click for all of it.
void draw_name(const Ui& ui, const debug::Check& check, const Name& name, const std::string& id) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (ImGui::Selectable((name.criterion + "##" + id).c_str(), false,
                        ImGuiSelectableFlags_SpanAllColumns) &&
      !check.option.empty())
    ui.emit("option.show", check.option);
  ui.name(id);
  if (ImGui::IsItemHovered()) draw_tooltip(check);
  const float beside = name.beside ? ImGui::CalcTextSize(name.criterion.c_str()).x + ui.px(6) : 0;
  const float drop = ImGui::GetTextLineHeight() - ui.small->FontSize;  // to the same foot
  ImGui::GetWindowDrawList()->AddText(ui.small, ui.small->FontSize,
                                      ImVec2(at.x + beside, at.y + drop), ui.colors.muted,
                                      name.equation.c_str());
}

}  // namespace

void draw_checks(const Ui& ui, const std::string& name, const std::vector<debug::Check>& checks) {
  const bool wide = ImGui::GetContentRegionAvail().x > ui.px(330);  // for equations and margins
  const std::vector<Name> names = names_of(checks, wide);
  float widest = 0;
  for (const Name& one : names) widest = std::max(widest, width_of(ui, one));
  if (!ImGui::BeginTable(("##checks." + name).c_str(), wide ? 4 : 3,
                         ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH))
    return;
  ImGui::TableSetupColumn("criterion", ImGuiTableColumnFlags_WidthFixed, widest);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("verdict", ImGuiTableColumnFlags_WidthFixed, ui.px(32));
  if (wide) ImGui::TableSetupColumn("margin", ImGuiTableColumnFlags_WidthFixed, ui.px(40));
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const debug::Check& check = checks[i];
    const bool asked = check.verdict != debug::Verdict::not_asked;
    const ImU32 color = asked ? ui.colors.text : ui.colors.muted;
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    draw_name(ui, check, names[i], fmt::format("check.{}.{}", name, i));
    ImGui::TableNextColumn();
    draw_comparison(ui, check, color);
    ImGui::TableNextColumn();
    const ImU32 verdict = !asked                                  ? ui.colors.muted
                          : check.verdict == debug::Verdict::pass ? ui.colors.good
                                                                  : ui.colors.bad;
    if (!check.op.empty())
      ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(verdict), "%s", word_of(check.verdict));
    if (wide) ImGui::TableNextColumn();
    if (wide && !check.op.empty()) draw_margin(ui, check);
    ImGui::PopStyleColor();
  }
  ImGui::EndTable();
}

}  // namespace planescope::desktop
