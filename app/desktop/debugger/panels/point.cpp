// A point's whole life, and the one decision that put it in no plane or in the wrong one.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

/// The source of the selected point; the last one told of where none is selected, since a click on
/// a line of its life selects a node.
std::int64_t source_to_tell(const Ui& ui, const debug::Run& run) {
  const Selection& selected = ui.state.view.selected;
  const debug::Subject& subject = *run.subject;
  if (selected.source >= 0) return selected.source;
  if (selected.voxel >= 0 && selected.voxel < static_cast<std::int32_t>(subject.voxel_count()))
    return static_cast<std::int64_t>(
        debug::source_of_voxel(subject, static_cast<std::uint32_t>(selected.voxel)));
  return ui.memory.point.source;
}

/// Made again where point or run changed; null where there is nothing to tell.
const PointStory* story(const Ui& ui) {
  const bool flashed = ui.state.view.flash && ui.state.results.pinned;
  const std::shared_ptr<const RunView>& view =
      flashed ? ui.state.results.pinned : ui.state.results.current;
  PointStory& point = ui.memory.point;
  const std::shared_ptr<const io::Recording>& recording = ui.state.document.current()->recording;
  const bool other_frame =
      point.of && (point.recording != recording ||
                   point.of->run->subject->frame.index != view->run->subject->frame.index);
  if (other_frame) point = {};
  const std::int64_t source = source_to_tell(ui, *view->run);
  if (source < 0) return nullptr;
  if (point.of != view || point.source != source) {
    const auto index = static_cast<std::size_t>(source);
    point = {recording, view, source, debug::life_of(*view->run, index),
             debug::why_not(*view->run, index)};
  }
  return &point;
}

void draw_why(const Ui& ui, const PointStory& point) {
  const bool lost = point.why.answer.starts_with("Lost");
  heading(ui, lost ? "Why not?" : "Plane");
  math_paragraph(ui, lost ? ui.colors.warning : ui.colors.text, point.why.answer);
  if (point.why.step > 0) {
    if (button(ui, fmt::format("Step {}", point.why.step), "point.why"))
      ui.act("step.goto", point.why.step);
    ImGui::SameLine();
    if (button(ui, "Break on this point", "point.break")) {
      ui.act("select.voxel",
             point.of->run->subject->voxel_of_source(static_cast<std::size_t>(point.source)));
      ui.act("break.point");
    }
  }
  if (draw_try(ui)) return;
  const debug::Remedy& remedy = point.why.remedy;
  if (remedy.text.empty()) return;
  paragraph(ui.colors.muted, remedy.text);
  if (button(ui, fmt::format("Set {} = {}", remedy.option, remedy.value), "point.remedy"))
    ui.act("option.set", OptionValue{remedy.option, remedy.value});
}

/// The stage with its step: beside it, or below where the panel is narrow.
bool steps_beside(const Ui& ui) { return ImGui::GetWindowWidth() > ui.px(340); }

float stage_width(const Ui& ui, const debug::LifeEvent& event) {
  const float stage = ImGui::CalcTextSize(event.stage.c_str()).x;
  if (event.step <= 0) return stage;
  const float step = ImGui::CalcTextSize(std::to_string(event.step).c_str()).x;
  return steps_beside(ui) ? stage + ui.px(7) + step : std::max(stage, step);
}

/// One line of the life; a click leads to its step.
void draw_station(const Ui& ui, const debug::LifeEvent& event, std::size_t index) {
  const std::int32_t now = ui.state.view.step;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushFont(ui.small);
  colored(event.decisive ? ui.colors.warning : ui.colors.muted, event.stage);
  if (event.step > 0) {
    if (steps_beside(ui)) ImGui::SameLine(0, ui.px(7));
    colored(event.step == now ? ui.colors.accent : ui.colors.muted, std::to_string(event.step));
  }
  ImGui::PopFont();
  ImGui::TableNextColumn();
  if (event.decisive)
    ImGui::TableSetBgColor(ImGuiTableBgTarget_RowBg0, with_alpha(ui.colors.warning, 28));
  const std::string widget = fmt::format("point.life.{}", index);
  const bool later = event.step > now;
  if (event.step < 0) {
    math_paragraph(ui, ui.colors.text, event.text);
    ui.name(widget);
    return;
  }
  const ImVec2 min = ImGui::GetCursorScreenPos();
  math_paragraph(ui, later ? ui.colors.muted : ui.colors.text, event.text);
  ui.name(widget);
  const ImVec2 max(min.x + ImGui::GetContentRegionAvail().x, ImGui::GetItemRectMax().y);
  if (!ImGui::IsMouseHoveringRect(min, max) || !ImGui::IsWindowHovered()) return;
  ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
  ImGui::GetWindowDrawList()->AddRect(min, max, ui.colors.accent, ui.px(2));
  if (ImGui::IsMouseClicked(0)) ui.act("step.goto", event.step);
}

}  // namespace

void draw_point(const Ui& ui) {
  const PointStory* point = ui.state.run() ? story(ui) : nullptr;
  if (!point) {
    paragraph(ui.colors.muted,
              "Click a point in the image or in the scene to see its pixel, voxel, label, nodes "
              "and every decision about it.");
    return;
  }
  draw_why(ui, *point);
  ImGui::Spacing();
  ImGui::Separator();
  heading(ui, "History");
  if (!ImGui::BeginTable("life", 2, ImGuiTableFlags_PadOuterX)) return;
  ImGui::PushFont(ui.small);
  float widest = 0;
  for (const debug::LifeEvent& event : point->life)
    widest = std::max(widest, stage_width(ui, event));
  ImGui::PopFont();
  ImGui::TableSetupColumn("stage", ImGuiTableColumnFlags_WidthFixed, widest + ui.px(4));
  ImGui::TableSetupColumn("text", ImGuiTableColumnFlags_WidthStretch);
  for (std::size_t i = 0; i < point->life.size(); ++i) draw_station(ui, point->life[i], i);
  ImGui::EndTable();
}

}  // namespace planescope::desktop
