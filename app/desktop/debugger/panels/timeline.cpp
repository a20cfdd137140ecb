// The trace from left to right: cases above, what became of planes below, and marks of what
// matters.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/debugger/axes.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

/// The scrubber's rows on screen, from top to bottom.
struct Rows {
  float x = 0, width = 0;
  float marks = 0, cases = 0, planes = 0, matches = 0, end = 0;  // upper edges
  std::int32_t steps = 0;

  int columns() const { return static_cast<int>(width); }
  float at(std::int32_t step) const {
    return x + static_cast<float>(column_of_step(step, steps, columns())) + 0.5f;
  }
  std::int32_t step_at(float screen_x) const {
    const double share = (screen_x - x) / std::max(1.0f, width - 1);
    return static_cast<std::int32_t>(std::lround(std::clamp(share, 0.0, 1.0) * steps));
  }
};

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
      if (ImGui::Selectable(fmt::format("{} steps a second", rate).c_str()))
        ui.emit("step.rate", std::to_string(rate));
    ImGui::EndCombo();
  }
  ui.name("timeline.rate");
  if (!run) return;
  ImGui::SameLine();
  int step = ui.state.view.step;
  ImGui::SetNextItemWidth(ui.px(62));
  if (ImGui::InputInt("##step", &step, 0, 0, ImGuiInputTextFlags_EnterReturnsTrue))
    ui.emit("step.goto", std::to_string(std::clamp(step, 0, run->steps())));
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
                               : "before the first event: all points wait in the root";
  const std::string shown = fitted(ui, text, ImGui::GetContentRegionAvail().x);
  math_text(ui, ui.colors.text, shown);
  if (shown != text) tooltip(text);
}

void draw_cases(const Ui& ui,
                const Rows& rows,
                const std::vector<TimelineColumn>& columns,
                ImDrawList* draw) {
  draw->AddRectFilled(ImVec2(rows.x, rows.cases), ImVec2(rows.x + rows.width, rows.planes - 2),
                      ui.colors.panel);
  const auto settles = [](const TimelineColumn& column) { return column.decided() > 0; };
  const auto end = std::find_if(columns.rbegin(), columns.rend(), settles).base();
  const TimelineColumn* last = nullptr;
  for (auto column = columns.begin(); column != end; ++column) {
    if (settles(*column)) last = &*column;
    if (!last) continue;  // a decision reaches to the next one
    const float x = rows.x + static_cast<float>(column - columns.begin());
    float y = rows.cases;
    for (int c = 1; c <= 4; ++c) {  // shares of the column's height
      const float height = (rows.planes - 2 - rows.cases) *
                           static_cast<float>(last->cases[static_cast<std::size_t>(c)]) /
                           static_cast<float>(last->decided());
      draw->AddRectFilled(ImVec2(x, y), ImVec2(x + 1, y + height),
                          to_imgui(render::case_color(static_cast<planes::Case>(c))));
      y += height;
    }
  }
}

/// Planes founded stand tallest; merges, assignments and changes less so.
void draw_plane_events(const Ui& ui,
                       const Rows& rows,
                       const std::vector<TimelineColumn>& columns,
                       ImDrawList* draw) {
  draw->AddRectFilled(ImVec2(rows.x, rows.planes), ImVec2(rows.x + rows.width, rows.matches - 2),
                      ui.colors.panel);
  const float height = rows.matches - 2 - rows.planes;
  render::StepLook look;
  look.color_of_plane = colors_of_planes(ui.state, *ui.state.run_view());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const TimelineColumn& column = columns[i];
    const float share = column.found > 0                          ? 1.0f
                        : column.merged > 0 || column.refined > 0 ? 0.7f
                        : column.assigned + column.dropped > 0    ? 0.4f
                                                                  : 0.0f;
    if (share == 0) continue;
    const float x = rows.x + static_cast<float>(i);
    const render::Rgba color =
        column.plane >= 0 ? look.plane_color(column.plane) : render::leftover_color();
    draw->AddRectFilled(ImVec2(x, rows.matches - 2 - share * height),
                        ImVec2(x + 1, rows.matches - 2), to_imgui(color));
  }
}

/// One tick per column at most, however many there are.
template <typename Mark>
void for_columns(const Rows& rows, const std::vector<std::int32_t>& steps, const Mark& mark) {
  float last = -1;
  for (const std::int32_t step : steps) {
    if (step > rows.steps) break;
    const float x = rows.at(step);
    if (x != last) mark(x);
    last = x;
  }
}

const std::vector<std::int32_t>& stops_of(const Ui& ui) {
  BreakpointStops& stops = ui.memory.breakpoint_stops;
  std::string all;
  for (const Breakpoint& b : ui.state.document.breakpoints)
    all += fmt::format("{}|{}|{}|{};", static_cast<int>(b.kind), b.filter, b.index, b.enabled);
  const std::shared_ptr<const debug::Run>& run = ui.state.run_view()->run;
  if (stops.run.lock() != run || stops.breakpoints != all)
    stops = {run, all, breakpoint_steps(*run, ui.state.document)};
  return stops.steps;
}

void draw_marks(const Ui& ui, const Rows& rows, ImDrawList* draw) {
  const float height = rows.cases - rows.marks;
  const float middle = rows.marks + height / 2;
  const float r = height * 0.36f;
  for_columns(rows, stops_of(ui),
              [&](float x) { draw->AddCircleFilled(ImVec2(x, middle), r, ui.colors.bad); });
  for (const Bookmark& bookmark : ui.state.document.bookmarks) {
    if (bookmark.frame != ui.state.document.frame || bookmark.step > rows.steps) continue;
    const float x = rows.at(bookmark.step);
    draw->AddTriangleFilled(ImVec2(x - r, rows.marks), ImVec2(x + r, rows.marks),
                            ImVec2(x, rows.cases - 1), ui.colors.accent);
  }
  for_columns(rows, ui.state.view.search.matches, [&](float x) {
    draw->AddLine(ImVec2(x, rows.matches), ImVec2(x, rows.end), ui.colors.accent);
  });
  const auto& comparison = ui.state.results.comparison;
  if (!comparison || ui.state.view.against != Against::pinned) return;
  const std::int32_t parts =
      ui.state.view.flash ? comparison->diverging_step_a : comparison->diverging_step_b;
  if (parts > rows.steps) return;
  const float x = rows.at(parts);
  draw->AddLine(ImVec2(x, rows.marks), ImVec2(x, rows.end), ui.colors.warning, ui.px(1.5f));
  draw->AddText(ui.small, ui.px(12), ImVec2(x + ui.px(3), rows.marks - ui.px(3)), ui.colors.warning,
                "A ≠ B");
}

void draw_cursor(const Ui& ui, const Rows& rows, ImDrawList* draw) {
  const float x = rows.at(ui.state.view.step);
  const float r = ui.px(4);
  draw->AddLine(ImVec2(x, rows.marks), ImVec2(x, rows.end), ui.colors.text, ui.px(1.5f));
  draw->AddTriangleFilled(ImVec2(x - r, rows.end), ImVec2(x + r, rows.end),
                          ImVec2(x, rows.end - 1.6f * r), ui.colors.text);
}

void tell(const Ui& ui, std::int32_t step) {
  const debug::Run& run = *ui.state.run();
  ImGui::SetTooltip("step %d\n%s", step,
                    step > 0 ? debug::describe_event(run, step).c_str() : "before the first event");
}

}  // namespace

void draw_timeline(const Ui& ui) {
  draw_step_controls(ui);
  const debug::Run* run = ui.state.run();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (!run || room.x < 16 || room.y < 16) return;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  Rows rows;
  rows.x = at.x;
  rows.width = std::floor(room.x);
  rows.marks = at.y;
  rows.cases = std::round(at.y + 0.2f * room.y);
  rows.planes = std::round(at.y + 0.6f * room.y);
  rows.matches = std::round(at.y + 0.85f * room.y);
  rows.end = at.y + room.y;
  rows.steps = run->steps();

  ImGui::InvisibleButton("scrubber", room);
  ui.name("timeline");
  const float mouse = ImGui::GetIO().MousePos.x;
  if (ImGui::IsItemActivated() && ui.state.view.playing.direction != 0) ui.emit("step.stop");
  if (ImGui::IsItemActive()) {
    const std::int32_t wanted = rows.step_at(mouse);
    if (wanted != ui.state.view.step) ui.emit("step.goto", std::to_string(wanted));
  } else if (ImGui::IsItemHovered()) {
    tell(ui, rows.step_at(mouse));
  }

  ImDrawList* draw = ImGui::GetWindowDrawList();
  const std::vector<TimelineColumn> columns = timeline_columns(*run, rows.columns());
  draw_cases(ui, rows, columns, draw);
  draw_plane_events(ui, rows, columns, draw);
  draw_marks(ui, rows, draw);
  draw_cursor(ui, rows, draw);
}

}  // namespace planescope::desktop
