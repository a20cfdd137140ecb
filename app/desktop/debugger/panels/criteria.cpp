// All options as sliders with typed entry, unit, default and reset, above the curve of the score as
// a function of the option.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

struct Row {
  const planes::OptionInfo& info;
  std::string value, reset;
  std::string widget;
};

/// Typographic unit; fractions and cosines have none.
std::string unit_text(const std::string& unit) {
  if (unit == "m2") return "m²";
  if (unit == "deg") return "°";
  return unit == "1" || unit == "share" ? "" : unit;
}

/// Draws a sensitivity curve on the slider's scale.
void draw_strip(const Ui& ui,
                const debug::Sensitivity& strip,
                const SliderScale& scale,
                ImVec2 min,
                ImVec2 max) {
  if (strip.values.size() < 2) return;
  const auto [low, high] = std::minmax_element(strip.scores.begin(), strip.scores.end());
  const double span = std::max(*high - *low, 1e-9);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  ImVec2 before;
  for (std::size_t i = 0; i < strip.values.size(); ++i) {
    const float x = min.x + static_cast<float>(scale.share(strip.values[i])) * (max.x - min.x);
    // Draw a flat line in the middle.
    const double share = *high > *low ? (strip.scores[i] - *low) / span : 0.5;
    const float y = max.y - ui.px(2) - static_cast<float>(share) * (max.y - min.y - ui.px(4));
    if (i > 0) draw->AddLine(before, ImVec2(x, y), ui.colors.accent, ui.px(1.3f));
    before = ImVec2(x, y);
  }
}

/// The score at the tried value nearest to `at`, and its range.
std::string curve_text(const Row& row, const debug::Sensitivity& strip, double at) {
  if (strip.values.empty()) return "";
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < strip.values.size(); ++i)
    if (std::abs(strip.values[i] - at) < std::abs(strip.values[nearest] - at)) nearest = i;
  const auto [low, high] = std::ranges::minmax(strip.scores);
  const std::string value = planes::number_text(row.info, strip.values[nearest]);
  return strip.against_truth
             ? fmt::format("\nMean IoU {:.2f} at {}; {:.2f} to {:.2f} over all values",
                           strip.scores[nearest], value, low, high)
             : fmt::format("\n{:g} planes at {}; {:g} to {:g} over all values",
                           strip.scores[nearest], value, low, high);
}

void draw_slider(const Ui& ui, const Row& row, double value) {
  const SliderScale scale = slider_scale(row.info, ui.state.document.options.segment.profile);
  const ImVec2 size(ImGui::GetContentRegionAvail().x, ui.px(22));
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const ImVec2 max(min.x + size.x, min.y + size.y);
  ImGui::InvisibleButton("slider", size);
  ui.name(row.widget + ".slider");
  const bool hot = ImGui::IsItemHovered() || ImGui::IsItemActive();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(
      min, max, ImGui::GetColorU32(hot ? ImGuiCol_FrameBgHovered : ImGuiCol_FrameBg), ui.px(3));
  const auto x_of = [&](double v) { return min.x + static_cast<float>(scale.share(v)) * size.x; };
  const auto strip = ui.state.results.sensitivity.find(row.info.name);
  const bool known = strip != ui.state.results.sensitivity.end();
  if (known) draw_strip(ui, strip->second, scale, min, max);
  const float at_default = x_of(scale.standard);
  draw->AddLine(ImVec2(at_default, min.y), ImVec2(at_default, max.y), ui.colors.muted, ui.px(1));
  const float at = std::clamp(x_of(value), min.x + ui.px(2), max.x - ui.px(2));
  draw->AddRectFilled(ImVec2(at - ui.px(2.5f), min.y), ImVec2(at + ui.px(2.5f), max.y),
                      hot ? ui.colors.text : ui.colors.accent, ui.px(2));
  if (ImGui::IsItemHovered() && !ImGui::IsItemActive()) {
    const double share = std::clamp((ImGui::GetIO().MousePos.x - min.x) / size.x, 0.0f, 1.0f);
    tooltip(fmt::format("{} ({})\nDefault: {} {}{}", row.info.meaning, row.info.name, row.reset,
                        unit_text(row.info.unit),
                        known ? curve_text(row, strip->second, scale.value(share)) : ""));
  }
  if (ImGui::IsItemActive()) {
    const double share = std::clamp((ImGui::GetIO().MousePos.x - min.x) / size.x, 0.0f, 1.0f);
    const std::string text = planes::number_text(row.info, scale.value(share));
    if (text != row.value) ui.act("option.drag", OptionValue{row.info.name, text});
  }
  if (ImGui::IsItemDeactivated()) ui.act("option.drop");
}

/// An input box; typed text stays in the panel until Enter.
void draw_entry(const Ui& ui, const Row& row, float width) {
  std::string& text = ui.memory.texts[row.widget];
  double& editing = ui.memory.numbers[row.widget];
  if (editing == 0) text = row.value;
  ImGui::SetNextItemWidth(width);
  const bool entered = ImGui::InputText(
      "##entry", &text, ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
  ui.name(row.widget);
  const bool left = ImGui::IsItemDeactivatedAfterEdit();
  editing = ImGui::IsItemActive() ? 1 : 0;
  if ((entered || left) && text != row.value)
    ui.act("option.set", OptionValue{row.info.name, text});
}

void draw_reset(const Ui& ui, const Row& row) {
  if (row.value == row.reset) return;
  ImGui::SameLine();
  if (ImGui::SmallButton("reset")) ui.act("option.reset", row.info.name);
  ui.name(row.widget + ".reset");
}

/// Draws an option's title and, if there is room, its symbol. `rest` is the width of the items
/// after it.
void draw_title(const Ui& ui, const Row& row, float rest) {
  const std::string& symbol = row.info.symbol;
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(row.info.title.c_str());
  const float room = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x -
                     ImGui::GetItemRectMax().x - rest - ui.px(16);
  if (!symbol.empty() && math_width(ui, symbol) < room) {
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    math_text(ui, ui.colors.muted, symbol);
  }
  ImGui::PushFont(ui.small);
  const float code = ImGui::CalcTextSize(row.info.name.c_str()).x;
  if (code < room - (symbol.empty() ? 0 : math_width(ui, symbol) + ui.px(8))) {
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", row.info.name.c_str());
  }
  ImGui::PopFont();
}

void draw_number(const Ui& ui, const Row& row) {
  const float width = ui.px(74);
  const float unit = ImGui::CalcTextSize("points").x + ui.px(6);
  draw_title(ui, row, width + unit + (row.value == row.reset ? 0 : ui.px(56)));
  draw_reset(ui, row);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - width - unit);
  draw_entry(ui, row, width);
  ImGui::SameLine(0, ui.px(6));
  ImGui::TextDisabled("%s", unit_text(row.info.unit).c_str());
  draw_slider(ui, row, planes::number_of(row.info, ui.state.document.options));
}

void draw_other(const Ui& ui, const Row& row) {
  const planes::OptionInfo& info = row.info;
  if (info.kind == planes::OptionKind::on_off) {
    bool on = row.value == "on";
    if (ImGui::Checkbox(info.title.c_str(), &on))
      ui.act("option.set", OptionValue{info.name, on ? "on" : "off"});
    ui.name(row.widget);
  } else {
    std::vector<std::string> choices = info.choices;
    if (info.name == "classifier") choices = {"gcn", "pca", "truth"};
    const float width = ui.px(160);
    draw_title(ui, row, width);
    ImGui::SameLine(0, ui.px(10));
    ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - width);
    if (choices.empty()) {
      draw_entry(ui, row, width);
    } else {
      ImGui::SetNextItemWidth(width);
      const bool open = ImGui::BeginCombo("##choice", row.value.c_str());
      ui.name(row.widget);
      if (open) {
        for (const std::string& choice : choices) {
          if (ImGui::Selectable(choice.c_str(), choice == row.value))
            ui.act("option.set", OptionValue{info.name, choice});
          ui.name(row.widget + "." + choice);
        }
        ImGui::EndCombo();
      }
    }
  }
  tooltip(fmt::format("{} ({})", info.meaning, info.name));
  draw_reset(ui, row);
}

const char* title_of(const std::string& section) {
  if (section == "criteria") return "Criteria";
  if (section == "objective") return "Objective";
  if (section == "classifier") return "Classifier";
  if (section == "gravity") return "Gravity";
  if (section == "method") return "Method";
  if (section == "rivals") return "Options of the method";
  if (section == "foot") return "Foot";
  if (section == "stairs") return "Stairs, kerbs, ramps";
  return "Cloud and octree";
}

/// Settable sections first. The method comes last if it is ours, which it nearly always is.
std::vector<const char*> sections_of(planes::Method method) {
  if (method == planes::Method::ours)
    return {"criteria", "objective", "classifier", "cloud", "gravity", "foot", "stairs", "method"};
  return {"method", "rivals", "cloud", "gravity", "foot", "stairs"};
}

void draw_row(const Ui& ui, const Row& row) {
  ImGui::PushID(row.info.name.c_str());
  if (ui.state.view.focus == row.widget) ImGui::SetScrollHereY(0.2f);
  if (row.info.is_number())
    draw_number(ui, row);
  else
    draw_other(ui, row);
  ImGui::PopID();
}

/// Options of a section that affect a run with the current options on the current frame.
std::vector<const planes::OptionInfo*> infos_of(const State& state, std::string_view section) {
  const RunView* view = state.results.current.get();
  const std::optional<bool> images =
      view ? std::optional(!view->run->subject->frame.is_cloud()) : std::nullopt;
  const planes::PipelineOptions& options = state.document.options;
  std::vector<const planes::OptionInfo*> infos;
  for (const planes::OptionInfo& info : planes::option_table()) {
    // foot_radius_m enables the others of its section.
    const bool matters = info.matters(options) || info.name == "foot_radius_m";
    if (info.section == section && matters && !planes::is_idle(info, options, images))
      infos.push_back(&info);
  }
  return infos;
}

}  // namespace

void draw_criteria(const Ui& ui) {
  const planes::PipelineOptions& options = ui.state.document.options;
  planes::PipelineOptions defaults;
  defaults.segment = planes::profile_options(options.segment.profile);
  for (const char* section : sections_of(options.method)) {
    const std::vector<const planes::OptionInfo*> infos = infos_of(ui.state, section);
    if (infos.empty()) continue;
    const std::string focused = ui.state.view.focus;
    const bool sought = focused.starts_with("criteria.") &&
                        planes::find_option(focused.substr(9)).section == section;
    if (sought) ImGui::SetNextItemOpen(true);
    const bool steers = section == std::string("criteria") || section == std::string("objective");
    const bool open = ImGui::CollapsingHeader(
        title_of(section),
        steers || options.method != planes::Method::ours ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    ui.name(std::string("criteria.section.") + section);
    if (!open) continue;
    if (section == std::string("gravity")) draw_gravity(ui);
    for (const planes::OptionInfo* info : infos)
      draw_row(ui, {*info, info->get(options), info->get(defaults), "criteria." + info->name});
  }
}

}  // namespace planescope::desktop
