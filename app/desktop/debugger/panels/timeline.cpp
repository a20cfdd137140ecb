// Timeline of the trace: phases, cases, planes, marks, and an overview.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

void draw_step_unit(const Ui& ui) {
  struct Unit {
    debug::StepUnit unit;
    const char *name, *title, *does;
  };
  static constexpr Unit kUnits[] = {
      {debug::StepUnit::event, "event", "Event", "to the next event"},
      {debug::StepUnit::node, "node", "Node", "to the next decided node"},
      {debug::StepUnit::plane, "plane", "Plane",
       "to the next event that creates, merges, splits, or drops a plane"}};
  const Unit& now = kUnits[static_cast<std::size_t>(ui.state.view.step_unit)];
  ImGui::SetNextItemWidth(ui.px(74));
  if (ImGui::BeginCombo("##unit", now.title)) {
    for (const Unit& unit : kUnits) {
      if (ImGui::Selectable(unit.title, unit.unit == now.unit)) ui.act("step.unit", unit.unit);
      ui.name(std::string("timeline.unit.") + unit.name);
      tooltip(unit.does);
    }
    ImGui::EndCombo();
  } else {
    tooltip(fmt::format("Step {} (Shift+R)", now.does));
  }
  ui.name("timeline.unit");
}

void draw_step_controls(const Ui& ui) {
  const debug::Run* run = ui.state.run();
  const Playing& playing = ui.state.view.playing;
  action_button(ui, "step.first", "⇤");
  ImGui::SameLine();
  action_button(ui, "step.previous", "←");
  ImGui::SameLine();
  action_button(ui, playing.direction == 0 ? "step.play" : "step.stop",
                playing.direction == 0 ? "▶" : "■");
  ImGui::SameLine();
  action_button(ui, "step.next", "→");
  ImGui::SameLine();
  action_button(ui, "step.last", "⇥");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ui.px(78));
  if (ImGui::BeginCombo("##rate", fmt::format("{:g} /s", playing.steps_per_s).c_str())) {
    for (const int rate : {1, 5, 20, 60, 200, 1000, 5000})
      if (ImGui::Selectable(fmt::format("{} steps per second", rate).c_str()))
        ui.act("step.rate", static_cast<double>(rate));
    ImGui::EndCombo();
  }
  ui.name("timeline.rate");
  ImGui::SameLine();
  draw_step_unit(ui);
  if (!run) return;
  ImGui::SameLine();
  int step = ui.state.view.step;
  ImGui::SetNextItemWidth(ui.px(62));
  if (ImGui::InputInt("##step", &step, 0, 0, ImGuiInputTextFlags_EnterReturnsTrue))
    ui.act("step.goto", std::clamp(step, 0, run->steps()));
  ui.name("timeline.step");
  ImGui::SameLine();
  ImGui::TextDisabled("of %d", run->steps());
  ImGui::SameLine(0, ui.px(14));
  const planes::TraceEvent* event = ui.state.event();
  if (event && event->type == planes::EventType::decide) {
    case_badge(ui, static_cast<planes::Case>(event->node_case));
    ImGui::SameLine();
  }
  const std::string text =
      event || !run->is_ours() ? debug::describe_event(*run, ui.state.view.step)
      : run->steps() == 0      ? "nothing to step through on this frame"
                               : "before the first event: all points are in the root";
  const std::string shown = fitted(ui, text, ImGui::GetContentRegionAvail().x);
  math_text(ui, ui.colors.text, shown);
  if (shown != text) tooltip(text);
}

// ---- Mouse -------------------------------------------------------------------------------------

constexpr ImGuiButtonFlags kButtons = ImGuiButtonFlags_MouseButtonLeft |
                                      ImGuiButtonFlags_MouseButtonRight |
                                      ImGuiButtonFlags_MouseButtonMiddle;

void show(const Ui& ui, const debug::StepRange& shown, const debug::StepRange& wanted) {
  if (wanted != shown) ui.act("timeline.range", wanted);
}

/// Zooms around a step when scrolling over the item.
void zoom(const Ui& ui, const debug::StepRange& shown, std::int32_t about) {
  constexpr double kNotch = 0.75;
  const float wheel = ImGui::GetIO().MouseWheel;
  if (wheel == 0 || !ImGui::IsItemHovered()) return;
  show(ui, shown, zoomed(shown, about, std::pow(kNotch, wheel), ui.state.run()->steps()));
}

/// The button that drags the item; -1: none.
int dragging_button(TimelineMemory& memory) {
  if (ImGui::IsItemActivated())
    memory.button = ImGui::IsMouseClicked(0) ? 0 : ImGui::IsMouseClicked(1) ? 1 : 2;
  return ImGui::IsItemActive() ? memory.button : -1;
}

/// Pans the range with the right or middle button.
void pan(const Ui& ui, const TimelineRows& rows, int button) {
  TimelineMemory& memory = ui.memory.timeline;
  const debug::StepRange& shown = rows.axis.steps;
  if (ImGui::IsItemActivated()) memory.grabbed = shown.first;
  if (button != 1 && button != 2) return;
  const float by = ImGui::GetMouseDragDelta(button, 0).x / rows.axis.step_width();
  const std::int32_t first = memory.grabbed - static_cast<std::int32_t>(std::lround(by));
  show(ui, shown, moved(shown, first - shown.first, ui.state.run()->steps()));
}

/// Shows the tooltip above the timeline; below the mouse it would hide the steps.
void tip(const TimelineRows& rows, const std::string& text) {
  const float x = ImGui::GetIO().MousePos.x;
  ImGui::SetNextWindowPos(ImVec2(x, rows.phases - 2), ImGuiCond_Always,
                          ImVec2((x - rows.axis.x) / rows.axis.width, 1));
  ImGui::SetTooltip("%s", text.c_str());
}

const debug::Phase* phase_at(const Ui& ui, std::int32_t step) {
  const std::vector<debug::Phase>& phases = ui.memory.timeline.phases;
  const auto phase = std::ranges::find_if(
      phases, [&](const debug::Phase& one) { return std::max(step, 1) <= one.steps.last; });
  return phase == phases.end() ? nullptr : &*phase;
}

void use_phases(const Ui& ui, const TimelineRows& rows) {
  ImGui::SetCursorScreenPos(ImVec2(rows.axis.x, rows.phases));
  ImGui::InvisibleButton("phases", ImVec2(rows.axis.width, rows.marks - rows.phases), kButtons);
  ui.name("timeline.phases");
  const std::int32_t mouse = rows.axis.at(ImGui::GetIO().MousePos.x);
  zoom(ui, rows.axis.steps, mouse);
  const int button = dragging_button(ui.memory.timeline);
  pan(ui, rows, button);
  const debug::Phase* phase = phase_at(ui, mouse);
  if (!phase || !ImGui::IsItemHovered()) return;
  const auto [first, last] = phase->steps;
  if (ImGui::IsMouseDoubleClicked(0))
    show(ui, rows.axis.steps, {first == 1 ? 0 : first, last});
  else if (button < 0)
    tip(rows, fmt::format("{}: steps {} to {}, {}\nDouble-click to fit", phase->title, first, last,
                          counted(static_cast<std::size_t>(phase->steps.count()), "event")));
}

std::string step_text(const Ui& ui, std::int32_t step) {
  const debug::Phase* phase = phase_at(ui, step);
  if (step == 0 || !phase) return fmt::format("step {}\nbefore the first event", step);
  return fmt::format("step {}, {}\n{}", step, phase->title,
                     debug::describe_event(*ui.state.run(), step));
}

/// Handles the mouse and returns the step under it; -1 if the mouse is elsewhere.
std::int32_t use_steps(const Ui& ui, const TimelineRows& rows) {
  TimelineMemory& memory = ui.memory.timeline;
  ImGui::SetCursorScreenPos(ImVec2(rows.axis.x, rows.marks));
  ImGui::InvisibleButton("scrubber", ImVec2(rows.axis.width, rows.end - rows.marks), kButtons);
  ui.name("timeline");
  const std::int32_t mouse = rows.axis.at(ImGui::GetIO().MousePos.x);
  zoom(ui, rows.axis.steps, mouse);
  const int button = dragging_button(memory);
  pan(ui, rows, button);
  if (button == 0) {
    if (ImGui::IsItemActivated() && ui.state.view.playing.direction != 0) ui.act("step.stop");
    if (mouse != ui.state.view.step) ui.act("step.goto", mouse);
  }
  // A double click whose second press is dragged is a drag.
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0)) memory.double_clicked = true;
  if (memory.double_clicked && ImGui::IsMouseReleased(0)) {
    memory.double_clicked = false;
    if (!was_dragged()) ui.act("timeline.all");
  }
  if (button >= 0 || !ImGui::IsItemHovered()) return -1;
  tip(rows, step_text(ui, mouse));
  return mouse;
}

/// Drag the frame to scroll; click beside it to move it there.
void use_overview(const Ui& ui, const TimelineRows& rows) {
  TimelineMemory& memory = ui.memory.timeline;
  const debug::StepRange& shown = rows.axis.steps;
  const std::int32_t steps = ui.state.run()->steps();
  ImGui::SetCursorScreenPos(ImVec2(rows.axis.x, rows.overview));
  ImGui::InvisibleButton("overview", ImVec2(rows.axis.width, rows.bottom - rows.overview));
  ui.name("timeline.overview");
  const std::int32_t mouse = rows.whole(steps).at(ImGui::GetIO().MousePos.x);
  zoom(ui, shown, shown.contains(mouse) ? mouse : shown.first + shown.count() / 2);
  if (ImGui::IsItemActivated())
    memory.grabbed = shown.contains(mouse) ? mouse - shown.first : shown.count() / 2;
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0))
    ui.act("timeline.all");
  else if (ImGui::IsItemActive())
    show(ui, shown, moved(shown, mouse - memory.grabbed - shown.first, steps));
  else if (ImGui::IsItemHovered())
    ImGui::SetTooltip("steps %d to %d of %d\nDrag to scroll, double-click to show all", shown.first,
                      shown.last, steps);
}

}  // namespace

void draw_timeline(const Ui& ui) {
  draw_step_controls(ui);
  const debug::Run* run = ui.state.run();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (!run || room.x < 16 || room.y < ui.px(40)) return;
  const TimelineRows rows =
      timeline_rows(ui, ImGui::GetCursorScreenPos(), room, shown_steps(ui.state));
  refresh_timeline(ui, rows);
  use_phases(ui, rows);
  use_overview(ui, rows);
  const std::int32_t hovered = use_steps(ui, rows);
  draw_phases(ui, rows);
  draw_steps(ui, rows);
  draw_step_marks(ui, rows);
  draw_step_cursor(ui, rows, hovered);
  draw_overview(ui, rows);
}

}  // namespace planescope::desktop
