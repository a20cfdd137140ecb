#include "app/desktop/labeling/panels/parts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

void draw_lock(const Ui& ui, ImVec2 middle, ImU32 color) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float w = ui.px(4.5f), h = ui.px(4);
  const float top = middle.y - ui.px(0.5f);
  draw->AddRectFilled(ImVec2(middle.x - w, top), ImVec2(middle.x + w, top + 1.8f * h), color,
                      ui.px(1.5f));
  draw->PathArcTo(ImVec2(middle.x, top), ui.px(3.2f), std::numbers::pi_v<float>,
                  2 * std::numbers::pi_v<float>, 12);
  draw->PathStroke(color, false, ui.px(1.5f));
}

void draw_eye(const Ui& ui, ImVec2 middle, ImU32 color, bool closed) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float w = ui.px(6.5f), h = ui.px(5.5f);
  const ImVec2 left(middle.x - w, middle.y), right(middle.x + w, middle.y);
  for (const float side : {-h, h})
    draw->AddBezierQuadratic(left, ImVec2(middle.x, middle.y + 1.4f * side), right, color,
                             ui.px(1.4f));
  draw->AddCircleFilled(middle, ui.px(2.1f), color);
  if (closed)
    draw->AddLine(ImVec2(middle.x - w, middle.y + h), ImVec2(middle.x + w, middle.y - h), color,
                  ui.px(1.6f));
}

LabelFacts make_facts(const FrameLabels& labels, const labels::LabelGrid& grid) {
  LabelFacts facts;
  facts.statistics = labels::statistics_of(labels, grid);
  facts.planes.resize(labels.planes.size());
  std::vector<int> place(kPlaneIgnore + 1, -1);  // in the list, by id
  for (std::size_t i = 0; i < labels.planes.size(); ++i)
    place[static_cast<std::size_t>(labels.planes[i].id)] = static_cast<int>(i);
  for (std::size_t i = 0; i < labels.plane.data.size(); ++i) {
    const int at = place[labels.plane.data[i]];
    if (at < 0) continue;
    PlaneFacts& plane = facts.planes[static_cast<std::size_t>(at)];
    ++plane.pixels;
    plane.area_m2 += grid.pixel_area_m2(static_cast<std::uint32_t>(i),
                                        &labels.planes[static_cast<std::size_t>(at)].normal);
  }
  return facts;
}

}  // namespace

std::shared_ptr<const FrameLabels> labels_to_show(const Ui& ui) {
  const State& state = ui.state;
  std::shared_ptr<const FrameLabels> labels = state.labels();
  if (labels) return labels;
  const std::string& refusal =
      state.results.label.refusal.empty() ? state.results.refusal : state.results.label.refusal;
  if (!refusal.empty())
    paragraph(ui.colors.bad, refusal);
  else if (state.document.current())
    paragraph(ui.colors.muted, "Preparing the frame …");
  else
    draw_absence(ui);
  return nullptr;
}

const LabelFacts& facts_of(const Ui& ui, const std::shared_ptr<const FrameLabels>& labels) {
  KeptLabelFacts& kept = ui.memory.label_facts;
  if (kept.of.lock() != labels) kept = {labels, make_facts(*labels, ui.state.label_frame()->grid)};
  return kept.facts;
}

void plane_swatch(const Ui& ui, int plane, bool dimmed) {
  const float side = std::round(ImGui::GetFontSize() * 0.8f);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float y = at.y + (ImGui::GetTextLineHeight() - side) / 2;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImU32 color = to_imgui(render::plane_color(plane));
  if (dimmed)
    draw->AddRect(ImVec2(at.x, y), ImVec2(at.x + side, y + side), color, ui.px(2), 0, ui.px(1.5f));
  else
    draw->AddRectFilled(ImVec2(at.x, y), ImVec2(at.x + side, y + side), color, ui.px(2));
  ImGui::Dummy(ImVec2(side, ImGui::GetTextLineHeight()));
  ImGui::SameLine(0, ui.px(5));
  const std::string name = fmt::format("P{}", plane);
  dimmed ? ImGui::TextDisabled("%s", name.c_str()) : ImGui::TextUnformatted(name.c_str());
}

std::string tilt_text(const LabelPlane& plane, const FrameLabels& labels) {
  const double tilt_deg = labels::tilt_of(plane.normal, labels.gravity);
  return std::isnan(tilt_deg) ? "–" : fmt::format("{:.1f}°", tilt_deg);
}

std::string tilt_text(double tilt_deg) {
  return std::isnan(tilt_deg) ? "gravity unknown" : fmt::format("tilt {:.1f}°", tilt_deg);
}

void share_bar(double share, const std::string& text) {
  const float spacing = ImGui::GetStyle().ItemSpacing.x;
  ImGui::BeginGroup();  // one item, for its name and its tooltip
  ImGui::ProgressBar(static_cast<float>(share),
                     ImVec2(-ImGui::CalcTextSize(text.c_str()).x - spacing, 0), "");
  ImGui::SameLine();
  ImGui::TextUnformatted(text.c_str());
  ImGui::EndGroup();
}

bool icon_button(const Ui& ui, PlaneIcon icon, bool on, const std::string& widget) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size(ui.px(18), ImGui::GetTextLineHeight());
  const bool clicked = ImGui::InvisibleButton(widget.c_str(), size);
  ui.name(widget);
  const ImU32 color = ImGui::IsItemHovered() ? ui.colors.accent
                      : on                   ? ui.colors.text
                                             : with_alpha(ui.colors.muted, 0x50);
  const ImVec2 middle(at.x + size.x / 2, at.y + size.y / 2);
  if (icon == PlaneIcon::lock)
    draw_lock(ui, middle, color);
  else
    draw_eye(ui, middle, color, on);
  return clicked;
}

}  // namespace planescope::desktop
