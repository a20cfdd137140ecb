// The planes of the frame, the active plane and the wand's preview; parts shared with other panels.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/desktop/labeling/panels/parts.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/model/text.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {

// ---- Shared parts -------------------------------------------------------------------------------

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
  std::vector<int> place(kPlaneIgnore + 1, -1);  // index in the list, by id
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

// ---- Tab ----------------------------------------------------------------------------------------

namespace {

const char* name_of(LabelOrigin origin) {
  constexpr const char* kNames[] = {"by hand", "by the wand", "from the algorithm", "carried",
                                    "imported"};
  return kNames[static_cast<std::size_t>(origin)];
}

void draw_totals(const Ui& ui, const FrameLabels& labels, const LabelFacts& facts) {
  const labels::LabelStatistics& s = facts.statistics;
  const double share =
      s.measured == 0 ? 0 : static_cast<double>(s.labeled) / static_cast<double>(s.measured);
  share_bar(share, fmt::format("{:.0f} % labeled", 100 * share));
  ui.name("planes.labelled");
  const char* const sample = sample_name(*ui.state.label_frame());
  tooltip(
      fmt::format("{} of {} measured {}s, {} ignored", s.labeled, s.measured, sample, s.ignored));
  const LabelProgress progress = progress_of(ui.state);
  if (progress.frames > 1) {
    paragraph(ui.colors.muted, fmt::format("{} of {} frames labeled, {} reviewed", progress.labeled,
                                           progress.frames, progress.reviewed));
    ui.name("planes.progress");
  }
  if (labels.planes.empty()) return;
  std::string text =
      fmt::format("{}: {} h, {} v", counted(labels.planes.size(), "plane"), s.h, s.v);
  const auto hidden = std::ranges::count_if(labels.planes, &LabelPlane::hidden);
  if (hidden > 0) text += fmt::format("  ·  {} hidden with {} {}s", hidden, s.hidden, sample);
  if (hidden > 0) ImGui::AlignTextToFramePadding();
  paragraph(hidden > 0 ? ui.colors.warning : ui.colors.muted, text);
  if (hidden > 0) {
    ui.name("planes.hidden");
    same_line_if_fits("show all");
    action_button(ui, "label.show_all", "show all");
  }
}

void draw_beginnings(const Ui& ui) {
  action_button(ui, "label.take", "Use result");
  const CarryJob& carry = ui.state.results.label.carry;
  if (carry.running) {
    ImGui::ProgressBar(static_cast<float>(carry.progress), ImVec2(-ui.px(60), 0), "carrying …");
    ui.name("planes.carrying");
    ImGui::SameLine();
    if (button(ui, "Stop", "planes.stop_carrying")) ui.act("label.cancel");
    return;
  }
  if (const auto labels = ui.state.labels(); labels && !labels->is_cloud()) {
    same_line_if_fits("Carry to next");
    action_button(ui, "label.carry", "Carry to next");
  }
  if (!carry.done) return;
  const auto doubtful = std::ranges::count(carry.done->doubt, std::uint8_t{1});
  paragraph(ui.colors.warning,
            fmt::format("From frame {} by {}: {} doubtful pixels (Esc hides them)", carry.from,
                        carry.done->method, doubtful));
  ui.name("planes.doubt");
}

void draw_tooltip(const LabelPlane& plane, const PlaneFacts& facts, const char* sample) {
  std::string text =
      fmt::format("P{}, {}, {}", plane.id, name_of(plane.origin), counted(facts.pixels, sample));
  if (plane.confidence < 1) text += fmt::format("\nconfidence {:.0f} %", 100 * plane.confidence);
  ImGui::SetTooltip("%s\nClick to activate, double-click to frame it", text.c_str());
}

void draw_plane(const Ui& ui, const LabelPlane& plane, const PlaneFacts& facts, bool confidences) {
  const std::string id = std::to_string(plane.id), widget = "planes." + id;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  const bool active = ui.state.view.label.plane == plane.id;
  const ImVec2 at = ImGui::GetCursorPos();
  if (ImGui::Selectable(("##" + widget).c_str(), active,
                        ImGuiSelectableFlags_SpanAllColumns |
                            ImGuiSelectableFlags_AllowItemOverlap |
                            ImGuiSelectableFlags_AllowDoubleClick))
    ui.act(ImGui::IsMouseDoubleClicked(0) ? "label.look" : "label.plane", plane.id);
  ui.name(widget);
  if (ImGui::IsItemHovered()) draw_tooltip(plane, facts, sample_name(*ui.state.label_frame()));
  ImGui::SetCursorPos(at);
  plane_swatch(ui, plane.id, plane.hidden);
  cell(to_string(plane.label, "?"));
  cell(fmt::format("{:.3f}", facts.area_m2));
  cell(fmt::format("{:.1f}", 1000 * plane.rms_m));
  cell(std::to_string(plane.fragments));
  if (confidences)
    cell(plane.confidence < 1 ? fmt::format("{:.0f} %", 100 * plane.confidence) : "");
  ImGui::TableNextColumn();
  if (icon_button(ui, PlaneIcon::lock, plane.locked, widget + ".lock"))
    ui.act("label.lock", plane.id);
  tooltip(plane.locked ? "Unlock" : "Lock: no tool changes the plane");
  ImGui::SameLine(0, ui.px(2));
  if (icon_button(ui, PlaneIcon::eye, plane.hidden, widget + ".hide"))
    ui.act("label.hide", plane.id);
  tooltip(plane.hidden ? "Show" : "Hide: kept, but not drawn");
}

void draw_list(const Ui& ui, const FrameLabels& labels, const LabelFacts& facts, float height) {
  if (labels.planes.empty())
    return paragraph(ui.colors.muted,
                     "No plane is labeled yet. Click one with the wand (W) and accept it with "
                     "Enter, or start from the algorithm's result (T).");
  const bool confidences = std::ranges::any_of(
      labels.planes, [](const LabelPlane& plane) { return plane.confidence < 1; });
  if (!ImGui::BeginTable("planes", confidences ? 7 : 6, kTable | ImGuiTableFlags_ScrollY,
                         ImVec2(0, height)))
    return;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("plane", ImGuiTableColumnFlags_WidthStretch);
  fixed_column(" ", "h");
  fixed_column("m²", "00.000");
  fixed_column("mm", "00.0");
  fixed_column("parts", "0");
  if (confidences) fixed_column("sure", "100 %");
  fixed_column("  ", "", ui.px(38));
  ImGui::TableHeadersRow();
  for (std::size_t i = 0; i < labels.planes.size(); ++i)
    draw_plane(ui, labels.planes[i], facts.planes[i], confidences);
  ImGui::EndTable();
}

void draw_active(const Ui& ui, const FrameLabels& labels) {
  const int id = ui.state.view.label.plane;
  const LabelPlane* plane = labels::find_plane(labels, id);
  if (!plane)
    return paragraph(ui.colors.muted, id > 0 ? fmt::format("The next gesture creates P{}.", id)
                                             : "The next gesture creates a plane.");
  plane_swatch(ui, id, plane->hidden);
  ImGui::SameLine();
  ImGui::TextDisabled("%s%s", name_of(plane->origin), plane->locked ? ", locked" : "");
  ui.name("planes.active");
  paragraph(ui.colors.text,
            fmt::format("normal {:.3f}, {:.3f}, {:.3f}  ·  tilt {}", plane->normal.x(),
                        plane->normal.y(), plane->normal.z(), tilt_text(*plane, labels)));
  paragraph(ui.colors.text,
            fmt::format("offset {:.3f} m  ·  RMS {:.1f} mm", plane->offset_m, 1000 * plane->rms_m));
  constexpr const char* kButtons[][2] = {
      {"label.class.h", "h"}, {"label.class.v", "v"},     {"label.split", "split"},
      {"label.lock", "lock"}, {"label.hide", "hide"},     {"label.remove", "remove"},
      {"label.look", "look"}, {"label.fill", "fill"},     {"label.smooth", "smooth"},
      {"label.grow", "grow"}, {"label.specks", "specks"}, {"label.residual", "distance"}};
  bool first = true;
  for (const auto& [action, label] : kButtons) {
    if (!first) same_line_if_fits(label);
    first = false;
    action_button(ui, action, label);
  }
}

void draw_wand(const Ui& ui) {
  const LabelView& view = ui.state.view.label;
  if (view.tool != LabelTool::wand) return;
  ImGui::Separator();
  auto millimetres = static_cast<float>(1000 * view.wand_options.tolerance_m);
  // Draw the number beside the slider, where the grab cannot hide it.
  const std::string number = fmt::format("within {:.1f} mm", millimetres);
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("wand");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-ImGui::CalcTextSize("within 00.0 mm").x - ui.px(8));
  if (ImGui::SliderFloat("##tolerance", &millimetres, 1, 40, "", ImGuiSliderFlags_Logarithmic))
    ui.act("label.wand.tolerance", millimetres / 1000.0);
  ui.name("planes.tolerance");
  ImGui::SameLine();
  ImGui::TextDisabled("%s", number.c_str());
  if (view.wand.found) {
    const labels::FittedPlane& plane = view.wand.found->plane;
    paragraph(
        ui.colors.accent,
        fmt::format("{}  ·  {}  ·  RMS {:.1f} mm  ·  {}  ·  {}",
                    to_string(view.wand.found->label, "?"), area_text(plane.area_m2),
                    1000 * plane.rms_m, tilt_text(plane.tilt_deg),
                    counted(view.wand.found->pixels.size(), sample_name(*ui.state.label_frame()))));
    ui.name("planes.wand");
  } else if (!view.wand.why_not.empty()) {
    paragraph(ui.colors.warning, view.wand.why_not);
  }
}

}  // namespace

void draw_label_planes(const Ui& ui) {
  const std::shared_ptr<const FrameLabels> labels = labels_to_show(ui);
  if (!labels) return;
  const LabelFacts& facts = facts_of(ui, labels);
  draw_totals(ui, *labels, facts);
  draw_beginnings(ui);
  list_above(
      ui, "planes.below", [&](float height) { draw_list(ui, *labels, facts, height); },
      [&] {
        draw_active(ui, *labels);
        draw_wand(ui);
      });
}

}  // namespace planescope::desktop
