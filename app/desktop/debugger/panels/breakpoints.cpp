#include "app/desktop/debugger/panels/breakpoints.hpp"

#include <fmt/format.h>

namespace planescope::desktop {
namespace {

std::string title_of(const Breakpoint& breakpoint) {
  switch (breakpoint.kind) {
    case Breakpoint::Kind::filter:
      return breakpoint.filter;
    case Breakpoint::Kind::node:
      return fmt::format("node {}", breakpoint.index);
    case Breakpoint::Kind::point:
      return fmt::format("point {}", breakpoint.index);
  }
  return {};
}

}  // namespace

BreakpointMarks::BreakpointMarks(const Document& document) {
  debug::FilterProblem problem;
  for (const Breakpoint& breakpoint : document.breakpoints)
    if (auto filter = debug::Filter::parse(filter_of(breakpoint), problem))
      stops_.push_back({std::move(*filter), breakpoint.enabled});
}

BreakpointMarks::Mark BreakpointMarks::of(const debug::Run& run, std::int32_t step) const {
  Mark mark = Mark::none;
  for (const Stop& stop : stops_) {
    if (mark == Mark::on || (mark == Mark::off && !stop.enabled)) continue;
    if (stop.filter.matches(run, step)) mark = stop.enabled ? Mark::on : Mark::off;
  }
  return mark;
}

void draw_breakpoint_dot(const Ui& ui, ImVec2 centre, BreakpointMarks::Mark mark) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float radius = ui.px(4.5f);
  if (mark == BreakpointMarks::Mark::on) draw->AddCircleFilled(centre, radius, ui.colors.bad, 16);
  if (mark == BreakpointMarks::Mark::off)
    draw->AddCircle(centre, radius, ui.colors.muted, 16, ui.px(1.2f));
}

void draw_breakpoints(const Ui& ui) {
  const auto& all = ui.state.document.breakpoints;
  const float line = ImGui::GetTextLineHeight();
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string title = title_of(all[i]);
    const std::string widget = fmt::format("events.breakpoint.{}", i);
    const float width = ImGui::CalcTextSize(title.c_str()).x + 2.4f * line;
    if (i > 0) {
      ImGui::SameLine(0, ui.px(10));
      if (ImGui::GetCursorScreenPos().x + width > right) ImGui::NewLine();
    }
    ImGui::PushID(static_cast<int>(i));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    if (ImGui::InvisibleButton("##switch", ImVec2(line, line)))
      ui.emit("break.enable", std::to_string(i));
    ui.name(widget);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s", all[i].enabled ? "Switch this breakpoint off" : "Switch it on");
    draw_breakpoint_dot(ui, ImVec2(at.x + line / 2, at.y + line / 2),
                        all[i].enabled ? BreakpointMarks::Mark::on : BreakpointMarks::Mark::off);
    ImGui::SameLine(0, ui.px(2));
    if (all[i].enabled)
      ImGui::TextUnformatted(title.c_str());
    else
      ImGui::TextDisabled("%s", title.c_str());
    ImGui::SameLine(0, ui.px(2));
    const ImVec2 cross = ImGui::GetCursorScreenPos();
    if (ImGui::InvisibleButton("##remove", ImVec2(line, line)))
      ui.emit("break.remove", std::to_string(i));
    ui.name(widget + ".remove");
    ImGui::GetWindowDrawList()->AddText(ImVec2(cross.x + ui.px(2), cross.y),
                                        ImGui::IsItemHovered() ? ui.colors.bad : ui.colors.muted,
                                        "✗");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Remove this breakpoint");
    ImGui::PopID();
  }
}

void toggle_breakpoint(const Ui& ui, const planes::TraceEvent& event) {
  if (event.node >= 0) {
    ui.emit("select.node", std::to_string(event.node));
    ui.emit("break.node");
  } else if (event.point >= 0) {
    ui.emit("select.voxel", std::to_string(event.point));
    ui.emit("break.point");
  } else {
    ui.emit("break.on", "plane==" + debug::plane_name(event.plane));
  }
}

}  // namespace planescope::desktop
