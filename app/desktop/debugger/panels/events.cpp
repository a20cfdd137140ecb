// Event list: the decisions step by step, with the filter and breakpoints.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

// ---- Breakpoints -------------------------------------------------------------------------------

enum class Mark : std::uint8_t { none, off, on };

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

/// Draws the dot of a breakpoint.
void draw_breakpoint_dot(const Ui& ui, ImVec2 center, Mark mark) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float radius = ui.px(4.5f);
  if (mark == Mark::on) draw->AddCircleFilled(center, radius, ui.colors.bad, 16);
  if (mark == Mark::off) draw->AddCircle(center, radius, ui.colors.muted, 16, ui.px(1.2f));
}

/// Draws all breakpoints in one line, each with a toggle and a close button.
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
    if (ImGui::InvisibleButton("##switch", ImVec2(line, line))) ui.act("break.enable", i);
    ui.name(widget);
    tooltip(all[i].enabled ? "Disable" : "Enable");
    draw_breakpoint_dot(ui, ImVec2(at.x + line / 2, at.y + line / 2),
                        all[i].enabled ? Mark::on : Mark::off);
    ImGui::SameLine(0, ui.px(2));
    if (all[i].enabled)
      ImGui::TextUnformatted(title.c_str());
    else
      ImGui::TextDisabled("%s", title.c_str());
    ImGui::SameLine(0, ui.px(2));
    const ImVec2 cross = ImGui::GetCursorScreenPos();
    if (ImGui::InvisibleButton("##remove", ImVec2(line, line))) ui.act("break.remove", i);
    ui.name(widget + ".remove");
    ImGui::GetWindowDrawList()->AddText(ImVec2(cross.x + ui.px(2), cross.y),
                                        ImGui::IsItemHovered() ? ui.colors.bad : ui.colors.muted,
                                        "✗");
    tooltip("Remove");
    ImGui::PopID();
  }
}

/// Toggles a breakpoint on the event's node or point.
void toggle_breakpoint(const Ui& ui, const debug::Run& run, const planes::TraceEvent& event) {
  if (event.node >= 0) {
    ui.act("select.node", event.node);
    ui.act("break.node");
  } else if (event.point >= 0) {
    ui.act("select.voxel", event.point);
    ui.act("break.point");
  } else {
    ui.act("break.on", "plane==" + debug::plane_name(run, event.plane));
  }
}

// ---- Filter ------------------------------------------------------------------------------------

bool shows_matches_only(const ViewState& view) { return view.only_matches && view.search.filter; }

/// One line: the filter's error or the number of matches.
void draw_findings(const Ui& ui, const debug::Run& run) {
  const Search& search = ui.state.view.search;
  if (!search.problem.message.empty()) {
    colored(ui.colors.bad, search.problem.message);
  } else if (!search.filter) {
    ImGui::TextDisabled("%s events", grouped(std::ssize(run.trace.events)).c_str());
  } else {
    const auto& matches = search.matches;
    const auto at = std::lower_bound(matches.begin(), matches.end(), ui.state.view.step);
    const bool on_one = at != matches.end() && *at == ui.state.view.step;
    const std::string place =
        on_one ? fmt::format("{} of ", grouped(at - matches.begin() + 1)) : std::string();
    ImGui::TextDisabled("%s%s matches among %s events", place.c_str(),
                        grouped(std::ssize(matches)).c_str(),
                        grouped(std::ssize(run.trace.events)).c_str());
  }
  ui.name("events.findings");
}

bool tool(const Ui& ui, const char* label, const char* widget, const char* help, bool pressed) {
  if (pressed)
    ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  const bool clicked = ImGui::Button(label);
  if (pressed) ImGui::PopStyleColor();
  ui.name(widget);
  tooltip(help);
  return clicked;
}

struct ReadyFilter {
  const char* title;
  const char* filter;
};

/// Frequently needed filters, for depth images segmented by the objective or for all other runs.
std::span<const ReadyFilter> ready_filters(const debug::Run& run) {
  static constexpr std::array kOfImage{
      ReadyFilter{"Narrowly accepted merges",
                  "(stage==join || stage==hidden) && value>0.8*merge_cost"},
      ReadyFilter{"Far merges of hidden parts", "stage==hidden"},
      ReadyFilter{"Large unassigned nodes", "decide && size>=1000 && (case==II || case==III)"},
      ReadyFilter{"Dropped planes", "stage==list"},
      ReadyFilter{"Narrowly dropped planes", "stage==list && value>0.8*worth_px"},
      ReadyFilter{"Largest losses",
                  "(stage==list && value>0.5*worth_px) || "
                  "(decide && size>=4000 && (case==II || case==III))"}};
  static constexpr std::array kOfPaper{
      ReadyFilter{"Far merges, over 2 cm", "merge && offset>0.02"},
      ReadyFilter{"Large unassigned nodes", "decide && size>=20 && (case==II || at_max_depth)"},
      ReadyFilter{"Nearly planar nodes", "decide && case==III && mse<1.25*theta_mse"},
      ReadyFilter{"Nearly assigned points", "drop && distance<2*leftover_distance_m"},
      ReadyFilter{"Dropped planes", "stage==list"},
      ReadyFilter{"Largest losses", "decide && size>=100 && (case==II || at_max_depth)"}};
  return run.segment_options.by_objective() && run.is_on_image()
             ? std::span<const ReadyFilter>(kOfImage)
             : std::span<const ReadyFilter>(kOfPaper);
}

void draw_ready_filters(const Ui& ui) {
  if (tool(ui, "…", "events.ready", "Preset filters", false)) ImGui::OpenPopup("ready");
  if (!ImGui::BeginPopup("ready")) return;
  const debug::Run* run = ui.state.run();
  const auto item = [&](const ReadyFilter& ready, std::size_t i) {
    if (ImGui::MenuItem(ready.title)) ui.act("filter.set", ready.filter);
    ui.name(fmt::format("events.ready.{}", i));
    tooltip(ready.filter);
  };
  std::size_t i = 0;
  if (run)
    for (const ReadyFilter& ready : ready_filters(*run)) item(ready, i++);
  if (run && run->subject->voxel_truth.known()) item({"Wrong decisions", "truth.wrong"}, i++);
  ImGui::EndPopup();
}

void draw_search(const Ui& ui) {
  const ViewState& view = ui.state.view;
  const float gap = ui.px(3);
  float tools = gap;
  for (const char* label : {"…", "◀", "▶", "only", "●"}) tools += button_width(label) + gap;
  draw_filter_box(ui,
                  {.widget = "events.filter",
                   .hint = "filter: case==III && depth>=5",
                   .text = view.search.text,
                   .problem = &view.search.problem,
                   .action = "filter.set",
                   .on_enter = "filter.next"},
                  std::max(ui.px(80), ImGui::GetContentRegionAvail().x - tools));
  ImGui::SameLine(0, gap);
  draw_ready_filters(ui);
  ImGui::SameLine(0, gap);
  if (tool(ui, "◀", "events.previous", "Previous match (Shift+N)", false))
    ui.act("filter.previous");
  ImGui::SameLine(0, gap);
  if (tool(ui, "▶", "events.next", "Next match (N)", false)) ui.act("filter.next");
  ImGui::SameLine(0, gap);
  if (tool(ui, "only", "events.only", "Show only matching events (Ctrl+Shift+F)",
           view.only_matches))
    ui.act("filter.only");
  ImGui::SameLine(0, gap);
  if (tool(ui, "●", "events.break", "Breakpoint on this filter (Shift+F9)", false))
    ui.act("break.filter");
}

// ---- List --------------------------------------------------------------------------------------

/// Offsets of a row's parts from its left edge.
struct Columns {
  float dot, step_right, sign, text;
};

Columns columns_of(const Ui& ui, const debug::Run& run) {
  const float line = ImGui::GetTextLineHeight();
  const float step = ImGui::CalcTextSize(std::to_string(run.steps()).c_str()).x;
  Columns columns{};
  columns.dot = line * 0.6f;
  columns.step_right = line * 1.2f + std::max(step, 2 * line);
  columns.sign = columns.step_right + ui.px(8);
  columns.text = columns.sign + line * 1.5f + ui.px(8);
  return columns;
}

/// The symbol of a kind of event; decisions have their case's badge instead.
std::string sign_of(const planes::TraceEvent& event) {
  switch (event.type) {
    case planes::EventType::visit:
      return "○";
    case planes::EventType::decide:
      return planes::to_string(static_cast<planes::Case>(event.node_case));
    case planes::EventType::found:
      return "★";
    case planes::EventType::merge:
      return "⊕";
    case planes::EventType::assign:
      return "→";
    case planes::EventType::drop:
      return "✗";
    case planes::EventType::refine:
      switch (event.stage) {
        case planes::Stage::join:
        case planes::Stage::hidden:
          return "⊕";
        case planes::Stage::grow:
          return "±";
        case planes::Stage::list:
          return "✗";
        default:
          return planes::to_string(event.stage);
      }
  }
  return {};
}

void draw_sign(const Ui& ui, const planes::TraceEvent& event, ImVec2 at, ImU32 color) {
  const float width = ImGui::GetTextLineHeight() * 1.5f;
  if (event.type == planes::EventType::decide) {
    ImGui::SetCursorScreenPos(at);
    return case_badge(ui, static_cast<planes::Case>(event.node_case));
  }
  const std::string sign = sign_of(event);
  const float extent = ImGui::CalcTextSize(sign.c_str()).x;
  ImGui::GetWindowDrawList()->AddText(ImVec2(at.x + (width - extent) / 2, at.y), color,
                                      sign.c_str());
}

/// The event in words, without the stage name that the row's symbol already shows.
std::string event_words(const debug::Run& run, std::int32_t step) {
  const planes::TraceEvent& event = *run.event_at(step);
  std::string text = debug::describe_event(run, step);
  const std::string name = sign_of(event) + ": ";
  return text.starts_with(name) ? text.substr(name.size()) : text;
}

void draw_row(const Ui& ui, const debug::Run& run, std::int32_t step, const Columns& columns) {
  const ViewState& view = ui.state.view;
  const planes::TraceEvent& event = *run.event_at(step);
  const float line = ImGui::GetTextLineHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::PushID(step);
  const bool clicked =
      ImGui::Selectable("##event", step == view.step, ImGuiSelectableFlags_None, ImVec2(0, line));
  ImGui::PopID();
  const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
  const float gutter = at.x + line * 1.2f;
  ui.name(fmt::format("events.step.{}", step), ImVec2(gutter, min.y), max);
  ui.name(fmt::format("events.break.{}", step), min, ImVec2(gutter, max.y));
  const bool in_gutter = ImGui::GetIO().MousePos.x < gutter;
  if (clicked && in_gutter)
    toggle_breakpoint(ui, run, event);
  else if (clicked)
    ui.act("step.goto", step);

  const std::string text = debug::describe_event(run, step);
  const bool wrong = !run.wrong.empty() && run.wrong[static_cast<std::size_t>(step - 1)] != 0;
  tooltip(in_gutter ? "Breakpoint for this event"
                    : text + (wrong ? "\ndisagrees with ground truth" : ""));

  ImDrawList* draw = ImGui::GetWindowDrawList();
  const auto& matches = view.search.matches;
  if (view.search.filter && std::binary_search(matches.begin(), matches.end(), step))
    draw->AddRectFilled(ImVec2(at.x + columns.sign - ui.px(5), min.y),
                        ImVec2(at.x + columns.sign - ui.px(2), max.y), ui.colors.accent);
  const BreakpointStops& stops = stops_of(ui);
  const Mark mark = std::ranges::binary_search(stops.on, step)    ? Mark::on
                    : std::ranges::binary_search(stops.off, step) ? Mark::off
                                                                  : Mark::none;
  draw_breakpoint_dot(ui, ImVec2(at.x + columns.dot, at.y + line / 2), mark);
  if (mark == Mark::none && in_gutter && ImGui::IsItemHovered())
    draw_breakpoint_dot(ui, ImVec2(at.x + columns.dot, at.y + line / 2), Mark::off);

  // Future events are muted.
  const ImU32 color = step <= view.step ? ui.colors.text : ui.colors.muted;
  const std::string number = std::to_string(step);
  draw->AddText(ImVec2(at.x + columns.step_right - ImGui::CalcTextSize(number.c_str()).x, at.y),
                ui.colors.muted, number.c_str());
  const float sign_room = wrong ? ImGui::CalcTextSize("≠ truth").x + ui.px(8) : 0;
  const std::string words =
      fitted(ui, event_words(run, step), max.x - at.x - columns.text - sign_room);
  draw_math(ui, draw, ImVec2(at.x + columns.text, at.y), color, words);
  if (wrong)
    draw->AddText(ImVec2(at.x + columns.text + math_width(ui, words) + ui.px(8), at.y),
                  ui.colors.bad, "≠ truth");
  const ImVec2 below = ImGui::GetCursorScreenPos();
  draw_sign(ui, event, ImVec2(at.x + columns.sign, at.y), color);
  ImGui::SetCursorScreenPos(below);
}

/// Draws a stage as a centered title.
void draw_stage(const Ui& ui, const EventRow& row, const Columns& columns) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float line = ImGui::GetTextLineHeight();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddText(ui.bold, line, ImVec2(at.x + columns.sign, at.y), ui.colors.accent, row.title);
  const float from = at.x + columns.sign + ui.bold->CalcTextSizeA(line, FLT_MAX, 0, row.title).x;
  const float to = at.x + ImGui::GetContentRegionAvail().x;
  draw->AddLine(ImVec2(from + ui.px(8), at.y + line / 2), ImVec2(to, at.y + line / 2),
                ui.colors.grid);
  ImGui::Dummy(ImVec2(1, line));
  ui.name(fmt::format("events.stage.{}", row.first));
}

/// Draws a group of events of one kind; click to open or close it.
void draw_group(
    const Ui& ui, const debug::Run& run, const EventRow& row, bool open, const Columns& columns) {
  const std::int32_t step = ui.state.view.step;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float line = ImGui::GetTextLineHeight();
  ImGui::PushID(-row.first);
  const bool here = step >= row.first && step <= row.last;
  if (ImGui::Selectable("##group", here && !open, ImGuiSelectableFlags_None, ImVec2(0, line))) {
    std::set<std::int32_t>& all = ui.memory.events.open;
    if (all.erase(row.first) == 0) all.insert(row.first);
  }
  ImGui::PopID();
  ui.name(fmt::format("events.group.{}", row.first));
  tooltip(fmt::format("steps {} to {}", row.first, row.last));
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImU32 color = row.last <= step ? ui.colors.text : ui.colors.muted;
  const std::string number = std::to_string(row.first);
  draw->AddText(ImVec2(at.x + columns.step_right - ImGui::CalcTextSize(number.c_str()).x, at.y),
                ui.colors.muted, number.c_str());
  draw->AddText(ImVec2(at.x + columns.sign + ui.px(4), at.y), color, open ? "▾" : "▸");
  draw_math(ui, draw, ImVec2(at.x + columns.text, at.y), color, group_text(run, row));
}

/// All events in groups; groups opened by the user or containing the cursor list each event.
std::vector<EventRow> grouped_rows(const Ui& ui, const debug::Run& run) {
  EventGroups& kept = ui.memory.events;
  const std::shared_ptr<const debug::Run>& now = ui.state.run_view()->run;
  if (kept.run.lock() != now) kept = {now, event_groups(run), {}};
  return opened(kept.rows, kept.open, ui.state.view.step);
}

/// Only the matches, one by one.
std::vector<EventRow> rows_of(const std::vector<std::int32_t>& steps) {
  std::vector<EventRow> rows;
  for (const std::int32_t step : steps) rows.push_back({EventRow::Kind::event, step, step});
  return rows;
}

/// The row of the cursor: its event or group, otherwise the last row before it.
int row_of_step(const std::vector<EventRow>& rows, std::int32_t step) {
  int at = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].kind != EventRow::Kind::stage && rows[i].first <= step) at = static_cast<int>(i);
  return at;
}

/// Scrolls only when the cursor has moved out of view.
void keep_in_sight(const Ui& ui, int row, float row_height) {
  if (ui.memory.events_scrolled_to == ui.state.view.step) return;
  ui.memory.events_scrolled_to = ui.state.view.step;
  scroll_to_row(row, row_height);
}

void draw_list(const Ui& ui, const debug::Run& run) {
  const ViewState& view = ui.state.view;
  const bool some = shows_matches_only(view);
  const std::vector<EventRow> rows = some ? rows_of(view.search.matches) : grouped_rows(ui, run);
  const Columns columns = columns_of(ui, run);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, ui.px(3)));
  const float row_height = ImGui::GetTextLineHeightWithSpacing();
  keep_in_sight(ui, row_of_step(rows, view.step), row_height);
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()), row_height);
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (rows[at].kind == EventRow::Kind::stage)
        draw_stage(ui, rows[at], columns);
      else if (rows[at].kind == EventRow::Kind::group)
        draw_group(ui, run, rows[at], at + 1 < rows.size() && rows[at + 1].first == rows[at].first,
                   columns);
      else
        draw_row(ui, run, rows[at].first, columns);
    }
  ImGui::PopStyleVar();
  if (!rows.empty()) return;
  if (!run.is_ours()) return paragraph(ui.colors.muted, debug::describe_event(run, 0));
  ImGui::TextDisabled(some ? "No event matches this filter."
                           : "Nothing was decided on this frame.");
}

}  // namespace

void draw_events(const Ui& ui) {
  draw_search(ui);
  const debug::Run* run = ui.state.run();
  if (!run)
    return paragraph(ui.colors.muted, "The decisions on a frame are listed here, step by step.");
  draw_findings(ui, *run);
  draw_breakpoints(ui);
  ImGui::BeginChild("##events");
  draw_list(ui, *run);
  ImGui::EndChild();
}

}  // namespace planescope::desktop
