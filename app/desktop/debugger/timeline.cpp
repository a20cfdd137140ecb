// Debugger timeline: zooming and scrolling its range, and drawing its rows of events.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/widgets.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {

// ---- Range and positions ------------------------------------------------------------------------

namespace {

constexpr std::int32_t kFewestSteps = 10;  // minimum range when zooming

/// A range of `count` steps, moved into the trace.
debug::StepRange within(std::int32_t first, std::int32_t count, std::int32_t steps) {
  count = std::clamp(count, 1, steps + 1);
  first = std::clamp(first, 0, steps + 1 - count);
  return {first, first + count - 1};
}

}  // namespace

debug::StepRange shown_steps(const State& state) {
  const debug::Run* run = state.run();
  if (!run) return {};
  const std::optional<debug::StepRange>& chosen = state.view.shown_steps;
  return chosen ? within(chosen->first, chosen->count(), run->steps()) : traversal_of(*run);
}

debug::StepRange zoomed(const debug::StepRange& range,
                        std::int32_t about,
                        double factor,
                        std::int32_t steps) {
  std::int32_t count = static_cast<std::int32_t>(std::lround(range.count() * factor));
  if (factor > 1) count = std::max(count, range.count() + 1);  // zoom even with few steps
  if (factor < 1) count = std::min(count, range.count() - 1);
  count = std::clamp(count, std::min(kFewestSteps, steps + 1), steps + 1);
  const double share = (about - range.first + 0.5) / range.count();
  return within(static_cast<std::int32_t>(std::lround(about + 0.5 - share * count)), count, steps);
}

debug::StepRange moved(const debug::StepRange& range, std::int32_t by, std::int32_t steps) {
  return within(range.first + by, range.count(), steps);
}

debug::StepRange scrolled_to(const debug::StepRange& range, std::int32_t step, std::int32_t steps) {
  if (range.contains(step)) return range;
  const std::int32_t count = range.count(), room = count / 8;
  const bool near = step >= range.first - count && step <= range.last + count;
  const std::int32_t first = !near                ? step - count / 2
                             : step < range.first ? step - room
                                                  : step + room - count + 1;
  return within(first, count, steps);
}

std::int32_t StepAxis::at(float screen_x) const {
  const double share =
      std::clamp((screen_x - x) / static_cast<double>(std::max(1.0f, width)), 0.0, 1.0);
  return std::min(steps.last,
                  steps.first + static_cast<std::int32_t>(std::floor(share * steps.count())));
}

int column_of_step(std::int32_t step, const debug::StepRange& steps, int count) {
  const std::int64_t halves = 2 * static_cast<std::int64_t>(step - steps.first) + 1;
  return static_cast<int>(halves * count / (2 * static_cast<std::int64_t>(steps.count())));
}

std::vector<TimelineColumn> timeline_columns(const debug::Run& run,
                                             const debug::StepRange& steps,
                                             int count) {
  std::vector<TimelineColumn> columns(static_cast<std::size_t>(std::max(count, 0)));
  if (columns.empty()) return columns;
  for (std::int32_t step = std::max(1, steps.first); step <= steps.last; ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    TimelineColumn& column = columns[static_cast<std::size_t>(column_of_step(step, steps, count))];
    ++column.events;
    if (event.plane >= 0) column.plane = event.plane;
    switch (event.type) {
      case planes::EventType::decide:
        ++column.cases[event.node_case];
        break;
      case planes::EventType::found:
        ++column.found;
        break;
      case planes::EventType::merge:
        ++column.merged;
        break;
      case planes::EventType::assign:
        ++column.assigned;
        break;
      case planes::EventType::drop:
        ++column.dropped;
        break;
      case planes::EventType::refine:
        ++column.refined;
        break;
      case planes::EventType::visit:
        break;
    }
  }
  return columns;
}

// ---- Drawing ------------------------------------------------------------------------------------

namespace {

using planes::EventType;

/// Draw boxes for steps at least this wide, columns for narrower ones [px at scale 1].
constexpr float kLeastBox = 2;
constexpr float kLeastGap = 4;  // narrower boxes touch

ImU32 case_fill(planes::Case c) { return to_imgui(render::case_color(c)); }

/// Draws text in the middle of a box, if it fits.
void draw_in_box(
    const Ui& ui, ImDrawList* draw, ImVec2 min, ImVec2 max, ImU32 color, const char* text) {
  const float size = ui.px(12);
  const ImVec2 extent = ui.small->CalcTextSizeA(size, FLT_MAX, 0, text);
  if (extent.x + ui.px(4) > max.x - min.x) return;
  draw->AddText(ui.small, size,
                ImVec2(std::round((min.x + max.x - extent.x) / 2),
                       std::round((min.y + max.y - extent.y) / 2)),
                color, text);
}

void draw_case_columns(const TimelineRows& rows,
                       const std::vector<TimelineColumn>& columns,
                       ImDrawList* draw) {
  const auto settles = [](const TimelineColumn& column) { return column.decided() > 0; };
  const auto end = std::find_if(columns.rbegin(), columns.rend(), settles).base();
  const TimelineColumn* last = nullptr;
  for (auto column = columns.begin(); column != end; ++column) {
    if (settles(*column)) last = &*column;
    if (!last) continue;  // a decision extends to the next one
    const float x = rows.axis.x + static_cast<float>(column - columns.begin());
    float y = rows.cases;
    for (int c = 1; c <= 4; ++c) {  // fractions of the column's height
      const float height = (rows.planes - 2 - rows.cases) *
                           static_cast<float>(last->cases[static_cast<std::size_t>(c)]) /
                           static_cast<float>(last->decided());
      draw->AddRectFilled(ImVec2(x, y), ImVec2(x + 1, y + height),
                          case_fill(static_cast<planes::Case>(c)));
      y += height;
    }
  }
}

/// New planes are tallest; merges, assignments and changes are lower.
void draw_plane_columns(const TimelineRows& rows,
                        const std::vector<TimelineColumn>& columns,
                        const render::StepLook& look,
                        ImDrawList* draw) {
  const float bottom = rows.matches - 2, height = bottom - rows.planes;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const TimelineColumn& column = columns[i];
    const float share = column.found > 0                          ? 1.0f
                        : column.merged > 0 || column.refined > 0 ? 0.7f
                        : column.assigned + column.dropped > 0    ? 0.4f
                                                                  : 0.0f;
    if (share == 0) continue;
    const float x = rows.axis.x + static_cast<float>(i);
    const render::Rgba color =
        column.plane >= 0 ? look.plane_color(column.plane) : render::leftover_color();
    draw->AddRectFilled(ImVec2(x, bottom - share * height), ImVec2(x + 1, bottom), to_imgui(color));
  }
}

/// Nodes are at the top and planes at the bottom, as in columns, but no two boxes overlap
/// horizontally, so both have room for a name.
void draw_boxes(const Ui& ui,
                const TimelineRows& rows,
                const render::StepLook& look,
                ImDrawList* draw) {
  const debug::Run& run = *ui.state.run();
  const float top = rows.cases, bottom = rows.matches - 2, height = bottom - top;
  const float gap = rows.axis.step_width() >= ui.px(kLeastGap) ? 1.0f : 0.0f;
  for (std::int32_t step = std::max(1, rows.axis.steps.first); step <= rows.axis.steps.last;
       ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    const bool of_point = event.point >= 0;
    ImVec2 min(rows.axis.begin(step), top), max(rows.axis.begin(step + 1) - gap, bottom);
    render::Rgba fill = render::leftover_color();
    std::string name;
    if (event.type == EventType::visit) {
      min.y = top + 0.4f * height;
      max.y = top + 0.6f * height;
      draw->AddRectFilled(min, max, with_alpha(ui.colors.muted, 90));
      continue;
    }
    if (event.type == EventType::decide) {
      const auto c = static_cast<planes::Case>(event.node_case);
      max.y = std::round(top + 0.65f * height);
      fill = render::case_color(c);
      name = planes::to_string(c);
    } else {
      min.y = std::round(top + (of_point ? 0.65f : 0.35f) * height);
      if (event.plane >= 0) fill = look.plane_color(event.plane);
      if (event.plane >= 0 && !of_point) name = debug::plane_name(run, event.plane);
    }
    draw->AddRectFilled(min, max, to_imgui(fill));
    draw_in_box(ui, draw, min, max, text_on(fill), name.c_str());
  }
}

/// Calls `mark` for visible steps, at most once per pixel.
template <typename Mark>
void for_shown(const TimelineRows& rows, const std::vector<std::int32_t>& steps, const Mark& mark) {
  float last = -1;
  for (auto step = std::ranges::lower_bound(steps, rows.axis.steps.first);
       step != steps.end() && *step <= rows.axis.steps.last; ++step) {
    const float x = std::floor(rows.axis.middle(*step)) + 0.5f;
    if (x != last) mark(x);
    last = x;
  }
}

}  // namespace

const BreakpointStops& stops_of(const Ui& ui) {
  BreakpointStops& stops = ui.memory.breakpoint_stops;
  const std::shared_ptr<const debug::Run>& run = ui.state.run_view()->run;
  const std::vector<Breakpoint>& all = ui.state.document.breakpoints;
  if (stops.run.lock() != run || stops.breakpoints != all)
    stops = {run, all, breakpoint_steps(*run, all, true), breakpoint_steps(*run, all, false)};
  return stops;
}

TimelineRows timeline_rows(const Ui& ui, ImVec2 at, ImVec2 room, const debug::StepRange& shown) {
  TimelineRows rows;
  rows.axis = {shown, at.x, std::floor(room.x)};
  rows.bottom = at.y + room.y;
  rows.overview = rows.bottom - std::round(ui.px(8));
  rows.end = rows.overview - std::round(ui.px(2));
  rows.phases = at.y;
  rows.marks = at.y + std::round(ui.px(16));
  rows.cases = rows.marks + std::round(ui.px(7));
  rows.matches = rows.end - std::round(ui.px(5));
  rows.planes = std::round(rows.cases + 0.55f * (rows.matches - rows.cases));
  return rows;
}

void refresh_timeline(const Ui& ui, const TimelineRows& rows) {
  TimelineMemory& kept = ui.memory.timeline;
  const std::shared_ptr<const debug::Run>& run = ui.state.run_view()->run;
  const auto count = static_cast<std::size_t>(rows.columns());
  const bool same = kept.run.lock() == run && kept.overview.size() == count;
  if (!same) {
    kept.run = run;
    kept.phases = debug::phases_of(*run);
    kept.overview = timeline_columns(*run, {0, run->steps()}, rows.columns());
  }
  if (!same || kept.steps != rows.axis.steps) {
    kept.steps = rows.axis.steps;
    kept.columns = timeline_columns(*run, kept.steps, rows.columns());
  }
}

void draw_phases(const Ui& ui, const TimelineRows& rows) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float height = rows.marks - 2 - rows.phases, size = ui.px(12);
  const StepAxis& axis = rows.axis;
  for (std::size_t i = 0; i < ui.memory.timeline.phases.size(); ++i) {
    const debug::Phase& phase = ui.memory.timeline.phases[i];
    const std::int32_t first = i == 0 ? 0 : phase.steps.first;
    if (phase.steps.last < axis.steps.first || first > axis.steps.last) continue;
    const ImVec2 min(std::max(axis.x, axis.begin(first)), rows.phases);
    const float right = std::min(axis.x + axis.width, axis.begin(phase.steps.last + 1));
    const ImVec2 max(right - min.x > 4 ? right - 1 : right, rows.phases + height);
    const bool here = debug::StepRange{first, phase.steps.last}.contains(ui.state.view.step);
    draw->AddRectFilled(min, max, ImGui::GetColorU32(here ? ImGuiCol_Header : ImGuiCol_FrameBg));
    ui.name(fmt::format("timeline.phase.{}", i), min, max);
    const float room = max.x - min.x - ui.px(8);
    const bool fits = ui.small->CalcTextSizeA(size, FLT_MAX, 0, phase.title).x <= room;
    if (!fits && room < ui.px(36)) continue;
    ImGui::PushFont(ui.small);
    const std::string title = fits ? phase.title : fitted(ui, phase.title, room);
    ImGui::PopFont();
    draw->AddText(ui.small, size, ImVec2(std::round(min.x + ui.px(4)), rows.phases), ui.colors.text,
                  title.c_str());
  }
}

void draw_steps(const Ui& ui, const TimelineRows& rows) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float right = rows.axis.x + rows.axis.width;
  draw->AddRectFilled(ImVec2(rows.axis.x, rows.cases), ImVec2(right, rows.matches - 2),
                      ui.colors.panel);
  render::StepLook look;
  look.color_of_plane = colors_of_planes(ui.state, *ui.state.run_view());
  if (rows.axis.step_width() >= ui.px(kLeastBox)) return draw_boxes(ui, rows, look, draw);
  draw_case_columns(rows, ui.memory.timeline.columns, draw);
  draw_plane_columns(rows, ui.memory.timeline.columns, look, draw);
}

void draw_step_marks(const Ui& ui, const TimelineRows& rows) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float height = rows.cases - rows.marks;
  const float middle = rows.marks + height / 2;
  const float r = height * 0.36f;
  for_shown(rows, stops_of(ui).on,
            [&](float x) { draw->AddCircleFilled(ImVec2(x, middle), r, ui.colors.bad); });
  for (const Bookmark& bookmark : ui.state.document.bookmarks) {
    if (bookmark.frame != ui.state.document.frame || !rows.axis.steps.contains(bookmark.step))
      continue;
    const float x = rows.axis.middle(bookmark.step);
    draw->AddTriangleFilled(ImVec2(x - r, rows.marks), ImVec2(x + r, rows.marks),
                            ImVec2(x, rows.cases - 1), ui.colors.accent);
  }
  for_shown(rows, ui.state.view.search.matches, [&](float x) {
    draw->AddLine(ImVec2(x, rows.matches), ImVec2(x, rows.end), ui.colors.accent);
  });
  const auto& comparison = ui.state.results.comparison;
  if (!comparison || ui.state.view.against != Against::pinned) return;
  const std::int32_t parts =
      ui.state.view.flash ? comparison->diverging_step_a : comparison->diverging_step_b;
  if (!rows.axis.steps.contains(parts)) return;
  const float x = rows.axis.middle(parts);
  draw->AddLine(ImVec2(x, rows.marks), ImVec2(x, rows.end), ui.colors.warning, ui.px(1.5f));
  draw->AddText(ui.small, ui.px(12), ImVec2(x + ui.px(3), rows.marks - ui.px(3)), ui.colors.warning,
                "A ≠ B");
}

void draw_step_cursor(const Ui& ui, const TimelineRows& rows, std::int32_t hovered) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const StepAxis& axis = rows.axis;
  const std::int32_t step = ui.state.view.step;
  const bool boxes = axis.step_width() >= ui.px(kLeastGap);
  const auto outline = [&](std::int32_t at, ImU32 color, float thickness) {
    if (boxes)
      draw->AddRect(ImVec2(axis.begin(at) - 1, rows.cases - 1),
                    ImVec2(axis.begin(at + 1), rows.matches - 1), color, 0, 0, thickness);
    else
      draw->AddLine(ImVec2(axis.middle(at), rows.cases - 1), ImVec2(axis.middle(at), rows.matches),
                    color, thickness);
  };
  if (hovered >= 0 && hovered != step) outline(hovered, ui.colors.muted, ui.px(1));
  const float r = ui.px(4);
  if (!axis.steps.contains(step)) {
    const bool right = step > axis.steps.last;
    const float tip = right ? axis.x + axis.width : axis.x, back = right ? -2 * r : 2 * r;
    const float y = (rows.cases + rows.matches) / 2;
    const ImVec2 a(tip + back, y - 1.5f * r), b(tip, y), c(tip + back, y + 1.5f * r);
    draw->AddTriangleFilled(a, b, c, ui.colors.text);
    draw->AddTriangle(a, b, c, ui.colors.panel, ui.px(1));
    return;
  }
  outline(step, ui.colors.text, ui.px(1.5f));
  const float x = axis.middle(step);
  if (!boxes)
    draw->AddLine(ImVec2(x, rows.marks), ImVec2(x, rows.end), ui.colors.text, ui.px(1.5f));
  draw->AddTriangleFilled(ImVec2(x - r, rows.end), ImVec2(x + r, rows.end),
                          ImVec2(x, rows.end - 1.5f * r), ui.colors.text);
}

void draw_overview(const Ui& ui, const TimelineRows& rows) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const StepAxis whole = rows.whole(ui.state.run()->steps());
  const float right = whole.x + whole.width;
  draw->AddRectFilled(ImVec2(whole.x, rows.overview), ImVec2(right, rows.bottom), ui.colors.panel);
  const std::vector<TimelineColumn>& columns = ui.memory.timeline.overview;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].events == 0) continue;
    const auto most = std::ranges::max_element(columns[i].cases);
    const auto c = static_cast<planes::Case>(most - columns[i].cases.begin());
    const float x = whole.x + static_cast<float>(i);
    draw->AddRectFilled(ImVec2(x, rows.overview + 2), ImVec2(x + 1, rows.bottom - 2),
                        *most > 0 ? case_fill(c) : with_alpha(ui.colors.muted, 120));
  }
  const float cursor = whole.middle(ui.state.view.step);
  draw->AddLine(ImVec2(cursor, rows.overview), ImVec2(cursor, rows.bottom), ui.colors.text,
                ui.px(1.5f));
  if (rows.axis.steps.count() > ui.state.run()->steps()) return;  // all steps are visible
  const float from = whole.begin(rows.axis.steps.first);
  const float to = std::max(whole.begin(rows.axis.steps.last + 1), from + ui.px(4));
  const ImU32 shade = with_alpha(ui.colors.panel, 170);
  draw->AddRectFilled(ImVec2(whole.x, rows.overview), ImVec2(from, rows.bottom), shade);
  draw->AddRectFilled(ImVec2(to, rows.overview), ImVec2(right, rows.bottom), shade);
  draw->AddRect(ImVec2(from, rows.overview), ImVec2(to, rows.bottom), ui.colors.accent, 0, 0,
                ui.px(1));
}

}  // namespace planescope::desktop
