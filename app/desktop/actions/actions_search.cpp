// The filter, breakpoints, and running to what matters.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

void set_filter(State& state, const std::string& text) {
  Search& search = state.view.search;
  search.text = text;
  search.problem = {};
  search.filter = text.find_first_not_of(' ') == std::string::npos
                      ? std::nullopt
                      : debug::Filter::parse(text, search.problem);
  refresh_matches(state);
}

void to_match(State& state, int direction) {
  const Search& search = state.view.search;
  if (!search.filter)
    return say_hint(state, "no filter is set: type one above the events (Ctrl+F)",
                    [](const State& s) { return s.view.search.filter.has_value(); });
  const auto& matches = search.matches;
  if (matches.empty()) return say(state, "no event matches " + search.text);
  // Round the ends: a frame opens at its last step.
  const std::int32_t step = state.view.step;
  if (direction > 0) {
    const auto next = std::upper_bound(matches.begin(), matches.end(), step);
    if (next == matches.end()) say(state, "no later event matches: from the beginning");
    go_to_step(state, next == matches.end() ? matches.front() : *next);
  } else {
    const auto next = std::lower_bound(matches.begin(), matches.end(), step);
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
    const auto next = std::upper_bound(stops.begin(), stops.end(), state.view.step);
    go_to_step(state, next == stops.end() ? run.steps() : *next);
    if (next == stops.end()) say(state, "no breakpoint ahead: ran to the end");
  } else {
    const auto next = std::lower_bound(stops.begin(), stops.end(), state.view.step);
    go_to_step(state, next == stops.begin() ? 0 : *(next - 1));
    if (next == stops.begin()) say(state, "no breakpoint behind: ran back to the beginning");
  }
}

bool same(const Breakpoint& a, const Breakpoint& b) {
  return a.kind == b.kind && a.filter == b.filter && a.index == b.index;
}

void toggle_breakpoint(State& state, const Breakpoint& breakpoint) {
  auto& all = state.document.breakpoints;
  const auto at = std::find_if(all.begin(), all.end(),
                               [&](const Breakpoint& other) { return same(other, breakpoint); });
  if (at == all.end())
    all.push_back(breakpoint);
  else
    all.erase(at);
}

}  // namespace

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
  std::sort(stops.begin(), stops.end());
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  return stops;
}

std::vector<Action> search_actions() {
  const std::string menu = "Search";
  using Kind = Breakpoint::Kind;
  return {
      {"filter.set", "Filter events", "", "", "[FILTER]", set_filter, {}, {}},
      {"filter.clear",
       "Clear the filter",
       menu,
       "Shift+Escape",
       "",
       [](State& s, const std::string&) { set_filter(s, ""); },
       {},
       {}},
      {"filter.next",
       "Next match",
       menu,
       "N",
       "",
       [](State& s, const std::string&) { to_match(s, 1); },
       has_run,
       {}},
      {"filter.previous",
       "Previous match",
       menu,
       "Shift+N",
       "",
       [](State& s, const std::string&) { to_match(s, -1); },
       has_run,
       {}},
      {"filter.only",
       "Show only matching events",
       menu,
       "Ctrl+Shift+F",
       "",
       [](State& s, const std::string&) { s.view.only_matches = !s.view.only_matches; },
       {},
       [](const State& s) { return s.view.only_matches; }},
      {"filter.focus",
       "Enter a filter",
       menu,
       "Ctrl+F",
       "",
       [](State& s, const std::string&) { s.view.focus = "events.filter"; },
       {},
       {}},
      {"break.node",
       "Breakpoint on the selected node",
       menu,
       "F9",
       "",
       [](State& s, const std::string&) {
         if (s.view.selected.node < 0)
           return say_hint(s, "no node is selected: click its box or its row in the tree",
                           [](const State& now) { return now.view.selected.node >= 0; });
         toggle_breakpoint(s, {Kind::node, "", s.view.selected.node, true});
       },
       has_run,
       {}},
      {"break.filter",
       "Breakpoint on the filter",
       menu,
       "Shift+F9",
       "",
       [](State& s, const std::string&) {
         if (!s.view.search.filter)
           return say_hint(s, "no filter is set: type one above the events (Ctrl+F)",
                           [](const State& now) { return now.view.search.filter.has_value(); });
         toggle_breakpoint(s, {Kind::filter, s.view.search.text, -1, true});
       },
       {},
       {}},
      {"break.point",
       "Breakpoint on the selected point",
       menu,
       "Ctrl+F9",
       "",
       [](State& s, const std::string&) {
         if (s.view.selected.voxel < 0)
           return say_hint(s, "no point is selected: click one in the image or in space",
                           [](const State& now) { return now.view.selected.voxel >= 0; });
         toggle_breakpoint(s, {Kind::point, "", s.view.selected.voxel, true});
       },
       has_run,
       {}},
      {"break.on",
       "Breakpoint on a filter expression",
       menu,
       "Alt+F9",
       "FILTER",
       [](State& s, const std::string& text) {
         debug::FilterProblem problem;
         if (!debug::Filter::parse(text, problem))
           throw Error("action break.on: '" + text + "': " + problem.message);
         toggle_breakpoint(s, {Kind::filter, text, -1, true});
       },
       {},
       {}},
      {"break.enable",
       "Enable or disable a breakpoint",
       "",
       "",
       "NUMBER",
       [](State& s, const std::string& text) {
         Breakpoint& breakpoint = item_argument("break.enable", text, s.document.breakpoints);
         breakpoint.enabled = !breakpoint.enabled;
       },
       {},
       {}},
      {"break.remove",
       "Remove a breakpoint",
       "",
       "",
       "NUMBER",
       [](State& s, const std::string& text) {
         toggle_breakpoint(s,
                           Breakpoint(item_argument("break.remove", text, s.document.breakpoints)));
       },
       {},
       {}},
      {"break.clear",
       "Remove all breakpoints",
       menu,
       "Ctrl+Shift+F9",
       "",
       [](State& s, const std::string&) { s.document.breakpoints.clear(); },
       {},
       {}},
      {"run.forward",
       "Run to the next breakpoint",
       menu,
       "F5",
       "",
       [](State& s, const std::string&) { run_to(s, 1); },
       has_run,
       {}},
      {"run.back",
       "Run back to the previous breakpoint",
       menu,
       "Shift+F5",
       "",
       [](State& s, const std::string&) { run_to(s, -1); },
       has_run,
       {}},
  };
}

}  // namespace planescope::desktop
