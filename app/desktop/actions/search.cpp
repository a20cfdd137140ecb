// The filter, breakpoints, and running to what matters.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

void hint_at_filter(State& state) {
  say_hint(state, "no filter is set: type one above the events (Ctrl+F)",
           [](const State& s) { return s.view.search.filter.has_value(); });
}

void to_match(State& state, int direction) {
  const Search& search = state.view.search;
  if (!search.filter) return hint_at_filter(state);
  const auto& matches = search.matches;
  if (matches.empty()) return say(state, "no event matches " + search.text);
  // Round the ends: a frame opens at its last step.
  const std::int32_t step = state.view.step;
  if (direction > 0) {
    const auto next = std::ranges::upper_bound(matches, step);
    if (next == matches.end()) say(state, "no later event matches: from the beginning");
    go_to_step(state, next == matches.end() ? matches.front() : *next);
  } else {
    const auto next = std::ranges::lower_bound(matches, step);
    if (next == matches.begin()) say(state, "no earlier event matches: from the end");
    go_to_step(state, next == matches.begin() ? matches.back() : *(next - 1));
  }
  state.view.playing.direction = 0;
}

void run_to(State& state, int direction) {
  const debug::Run& run = *state.run();
  const std::vector<std::int32_t> stops = breakpoint_steps(run, state.document);
  state.view.playing.direction = 0;
  if (direction > 0) {
    const auto next = std::ranges::upper_bound(stops, state.view.step);
    go_to_step(state, next == stops.end() ? run.steps() : *next);
    if (next == stops.end()) say(state, "no breakpoint ahead: ran to the end");
  } else {
    const auto next = std::ranges::lower_bound(stops, state.view.step);
    go_to_step(state, next == stops.begin() ? 0 : *(next - 1));
    if (next == stops.begin()) say(state, "no breakpoint behind: ran back to the beginning");
  }
}

void toggle_breakpoint(State& state, const Breakpoint& breakpoint) {
  auto& all = state.document.breakpoints;
  const auto same = [&](const Breakpoint& other) {
    return other.kind == breakpoint.kind && filter_of(other) == filter_of(breakpoint);
  };
  if (std::erase_if(all, same) == 0) all.push_back(breakpoint);
}

}  // namespace

void refresh_matches(State& state) {
  Search& search = state.view.search;
  search.matches.clear();
  if (search.filter && state.run()) search.matches = search.filter->matching(*state.run());
}

void set_filter(State& state, const std::string& text) {
  Search& search = state.view.search;
  search.text = text;
  search.problem = {};
  search.filter = text.find_first_not_of(' ') == std::string::npos
                      ? std::nullopt
                      : debug::Filter::parse(text, search.problem);
  refresh_matches(state);
}

std::string filter_of(const Breakpoint& breakpoint) {
  if (breakpoint.kind == Breakpoint::Kind::filter) return breakpoint.filter;
  const char* what = breakpoint.kind == Breakpoint::Kind::node ? "node" : "point";
  return fmt::format("{}=={}", what, breakpoint.index);
}

std::vector<std::int32_t> breakpoint_steps(const debug::Run& run, const Document& document) {
  std::vector<std::int32_t> stops;
  for (const Breakpoint& breakpoint : document.breakpoints) {
    if (!breakpoint.enabled) continue;
    debug::FilterProblem problem;
    if (const auto filter = debug::Filter::parse(filter_of(breakpoint), problem))
      for (const std::int32_t step : filter->matching(run)) stops.push_back(step);
  }
  std::ranges::sort(stops);
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  return stops;
}

void add_search_actions(std::vector<Action>& all) {
  const ActionGroup search{all, KeyMode::debugger, "Search"};
  const ActionGroup in_run{all, KeyMode::debugger, "Search", has_run};
  using Kind = Breakpoint::Kind;
  search.add("filter.set", "Filter events").run(text("[FILTER]"), set_filter);
  search.add("filter.clear", "Clear the filter").key("Shift+Escape").run([](State& s) {
    set_filter(s, "");
  });
  in_run.add("filter.next", "Next match").key("N").run([](State& s) { to_match(s, 1); });
  in_run.add("filter.previous", "Previous match").key("Shift+N").run([](State& s) {
    to_match(s, -1);
  });
  search.add("filter.only", "Show only matching events")
      .key("Ctrl+Shift+F")
      .flips(&ViewState::only_matches);
  search.add("filter.focus", "Enter a filter").key("Ctrl+F").run([](State& s) {
    s.view.focus = "events.filter";
  });
  in_run.add("break.node", "Breakpoint on the selected node").key("F9").run([](State& s) {
    if (s.view.selected.node < 0)
      return say_hint(s, "no node is selected: click its box or its row in the tree",
                      [](const State& now) { return now.view.selected.node >= 0; });
    toggle_breakpoint(s, {Kind::node, "", s.view.selected.node, true});
  });
  search.add("break.filter", "Breakpoint on the filter").key("Shift+F9").run([](State& s) {
    if (!s.view.search.filter) return hint_at_filter(s);
    toggle_breakpoint(s, {Kind::filter, s.view.search.text, -1, true});
  });
  in_run.add("break.point", "Breakpoint on the selected point").key("Ctrl+F9").run([](State& s) {
    if (s.view.selected.voxel < 0)
      return say_hint(s, "no point is selected: click one in the image or in space",
                      [](const State& now) { return now.view.selected.voxel >= 0; });
    toggle_breakpoint(s, {Kind::point, "", s.view.selected.voxel, true});
  });
  search.add("break.on", "Breakpoint on a filter expression")
      .key("Alt+F9")
      .run(text("FILTER"), [](State& s, const std::string& filter) {
        debug::FilterProblem problem;
        if (!debug::Filter::parse(filter, problem))
          throw Error("action break.on: '" + filter + "': " + problem.message);
        toggle_breakpoint(s, {Kind::filter, filter, -1, true});
      });
  const auto breakpoint = item(
      "NUMBER", [](const State& s) -> auto& { return s.document.breakpoints; });
  search.add("break.enable", "Enable or disable a breakpoint").run(breakpoint, [](State& s, int i) {
    bool& enabled = s.document.breakpoints[static_cast<std::size_t>(i)].enabled;
    enabled = !enabled;
  });
  search.add("break.remove", "Remove a breakpoint").run(breakpoint, [](State& s, int i) {
    s.document.breakpoints.erase(s.document.breakpoints.begin() + i);
  });
  search.add("break.clear", "Remove all breakpoints").key("Ctrl+Shift+F9").run([](State& s) {
    s.document.breakpoints.clear();
  });
  in_run.add("run.forward", "Run to the next breakpoint").key("F5").run([](State& s) {
    run_to(s, 1);
  });
  in_run.add("run.back", "Run back to the previous breakpoint").key("Shift+F5").run([](State& s) {
    run_to(s, -1);
  });
}

}  // namespace planescope::desktop
