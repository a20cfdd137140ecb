// Actions that move through the trace: the cursor, the range of the timeline, and pictures of
// steps.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/debugger/debugger.hpp"
#include "core/debug/explain/compare.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {

namespace {

/// The root; -1 for a frame without points.
std::int32_t root_of(const debug::Run& run) { return run.octree().nodes.empty() ? -1 : 0; }

/// Scrolls the timeline to the cursor.
void keep_cursor_shown(State& state) {
  const debug::StepRange shown = shown_steps(state);
  if (!shown.contains(state.view.step))
    state.view.shown_steps = scrolled_to(shown, state.view.step, state.run()->steps());
}

/// Switches colors after the user has stepped back from a step.
void color_traversal(State& state, std::int32_t from) {
  ViewState& view = state.view;
  if (view.case_colors != CaseColors::ready || view.color_by != render::ColorBy::planes) return;
  const debug::StepRange traversal = debug::traversal_of(*state.run());
  if (from <= traversal.last || !traversal.contains(view.step)) return;
  view.case_colors = CaseColors::shown;
  view.color_by = render::ColorBy::cases;
  say_hint(state, "colored by case while you step back; press 2 to color by plane",
           [](const State& now) { return now.view.case_colors != CaseColors::shown; });
}

void stop_and_go(State& state, std::int32_t step) {
  state.view.playing.direction = 0;
  go_to_step(state, step);
}

void stop_and_step(State& state, int count) {
  state.view.playing.direction = 0;
  step_by(state, count);
}

/// Case of the node decided at the step, or of the last one before it.
planes::Case case_at(const debug::Run& run, std::int32_t step) {
  for (; step > 0; --step)
    if (const planes::TraceEvent* event = run.event_at(step);
        event->type == planes::EventType::decide)
      return static_cast<planes::Case>(event->node_case);
  return planes::Case::I;
}

void to_same_case(State& state, int direction) {
  const debug::Run& run = *state.run();
  const planes::Case wanted = case_at(run, state.view.step);
  for (std::int32_t step = state.view.step + direction; step >= 1 && step <= run.steps();
       step += direction) {
    const planes::TraceEvent* event = run.event_at(step);
    if (event->type != planes::EventType::decide ||
        static_cast<planes::Case>(event->node_case) != wanted)
      continue;
    const std::int32_t from = state.view.step;
    stop_and_go(state, step);
    return color_traversal(state, from);
  }
  say(state, std::string("no ") + (direction > 0 ? "later" : "earlier") + " node of case " +
                 planes::to_string(wanted));
}

void hint_at_node(State& state) {
  say_hint(state, "no node is selected: click its box or its row in the tree",
           [](const State& now) { return now.view.selected.node >= 0; });
}

void go_to_decision(State& state) {
  const std::int32_t node = state.view.selected.node;
  if (node < 0) return hint_at_node(state);
  const std::int32_t step = state.run()->timeline.decided_at()[static_cast<std::size_t>(node)];
  if (step == planes::kNever) return say(state, "the selected node was never decided");
  go_to_step(state, step);
}

void play(State& state, int direction) {
  Playing& playing = state.view.playing;
  playing.direction = playing.direction == direction ? 0 : direction;
  playing.due = 0;
  if (playing.direction > 0 && state.view.step == state.run()->steps()) go_to_step(state, 0);
}

// ---- Pictures of steps -------------------------------------------------------------------------

constexpr int kMostPictures = 500;  // unless the argument sets the interval
constexpr const char* kSaveTakes = "PATH.png [FROM-TO [EVERY [PICTURES_PER_SECOND]]]";

[[noreturn]] void refuse_saving(const std::string& text) {
  throw Error("action steps.save: invalid argument '" + text + "'; expected " + kSaveTakes);
}

/// Parses the words after the path, which may contain spaces: "200-600 2 12".
void read_steps(const std::string& text, const std::vector<std::string>& words, StepsSaving& to) {
  const int steps = to.last;
  if (words.size() > 3) refuse_saving(text);
  if (!words.empty()) {
    const std::vector<std::string> ends = split(words[0], '-');
    if (ends.size() != 2) refuse_saving(text);
    to.first = whole_argument("steps.save", ends[0], 0, steps);
    to.last = whole_argument("steps.save", ends[1], to.first, steps);
  }
  to.every = 1 + (to.last - to.first) / kMostPictures;
  if (words.size() > 1) to.every = whole_argument("steps.save", words[1], 1, std::max(1, steps));
  if (words.size() > 2) to.per_s = whole_argument("steps.save", words[2], 1, 60);
}

/// The default range is from the cursor to the end, or all steps if the cursor is at the end.
void save_steps(State& state, const std::string& text) {
  std::size_t end = std::string::npos;
  for (const std::string ending : {".png", ".apng"})
    for (std::size_t at = text.find(ending); at != std::string::npos;
         at = text.find(ending, at + 1))
      if (const std::size_t after = at + ending.size(); after == text.size() || text[after] == ' ')
        end = std::min(end, after);
  if (end == std::string::npos)
    throw Error("action steps.save: '" + text +
                "' is not a PNG file; expected a name that ends in .png");
  if (state.view.saving) throw Error("action steps.save: already saving steps; press Esc to stop");
  const std::int32_t steps = state.run()->steps(), at = state.view.step;
  StepsSaving saving{.path = text.substr(0, end),
                     .run = state.run_view()->run,
                     .first = at < steps ? at : 0,
                     .last = steps};
  read_steps(text, words_of(text.substr(end)), saving);
  state.document.check_output(saving.path);
  std::error_code failed;
  const std::filesystem::path folder = std::filesystem::absolute(saving.path).parent_path();
  if (!std::filesystem::is_directory(folder, failed))
    throw Error(saving.path.string() + ": cannot be written: " + folder.string() +
                " is not a folder");
  if (std::filesystem::is_directory(saving.path, failed))
    throw Error(saving.path.string() + ": is a folder; expected a file");
  say(state, "");
  state.view.saving = saving;
}

// ---- Timeline ----------------------------------------------------------------------------------

/// Zooms around the cursor if it is visible, otherwise around the middle.
void zoom_by(State& state, double factor) {
  const debug::StepRange shown = shown_steps(state);
  const std::int32_t cursor = state.view.step;
  const std::int32_t about = shown.contains(cursor) ? cursor : shown.first + shown.count() / 2;
  state.view.shown_steps = zoomed(shown, about, factor, state.run()->steps());
}

/// Shows the phase of the cursor. The first phase includes the step before its first event.
void show_phase(State& state) {
  for (const debug::Phase& phase : debug::phases_of(*state.run())) {
    if (phase.steps.last < state.view.step) continue;
    const std::int32_t first = phase.steps.first == 1 ? 0 : phase.steps.first;
    state.view.shown_steps = {first, phase.steps.last};
    return;
  }
}

debug::StepRange read_range(const State& state,
                            const std::string& action,
                            const std::string& text) {
  const std::vector<std::string> ends = split(text, '-');
  if (ends.size() != 2)
    throw Error(fmt::format("action {}: '{}' is not a range; expected FIRST-LAST", action, text));
  const int first = whole_argument(action, ends[0], 0, state.run()->steps());
  return {first, whole_argument(action, ends[1], first, state.run()->steps())};
}

}  // namespace

// ---- Cursor ------------------------------------------------------------------------------------

void go_to_step(State& state, std::int32_t step) {
  const debug::Run* run = state.run();
  if (!run) return;
  state.view.step = std::clamp(step, 0, run->steps());
  keep_cursor_shown(state);
  if (state.view.case_colors == CaseColors::shown && state.view.step == run->steps()) {
    state.view.case_colors = CaseColors::ready;
    state.view.color_by = render::ColorBy::planes;
  }
  const planes::TraceEvent* event = state.event();
  Selection selected;
  if (!event) {
    selected.node = root_of(*run);
  } else if (state.view.step < run->steps()) {  // at the end, nothing is highlighted
    selected.node = debug::node_at_step(*run, state.view.step);
    selected.plane = event->plane;
    selected.voxel = event->point;
  }
  state.view.selected = selected;
}

void step_by(State& state, int count) {
  const std::int32_t from = state.view.step;
  go_to_step(state, debug::step_from(*state.run(), state.view.step_unit, from, count));
  if (count < 0) color_traversal(state, from);
}

void unflash(State& state) {
  if (!state.view.flash) return;
  const std::shared_ptr<const RunView> before = state.results.pinned;
  state.view.flash = false;
  if (before) follow_run(state, *before->run);
}

void follow_run(State& state, const debug::Run& before) {
  const debug::Run* now = state.run();
  if (!now || now == &before) return;
  Selection& selected = state.view.selected;
  const bool at_end = state.view.step == before.steps();
  state.view.step = at_end ? now->steps() : debug::same_step(before, state.view.step, *now);
  if (!at_end) keep_cursor_shown(state);
  selected.plane = -1;
  if (selected.node >= 0) {
    selected.node = debug::same_node(before, selected.node, *now);
    if (selected.node < 0) selected.node = root_of(*now);
  }
  if (selected.voxel >= 0 && now->subject != before.subject) {
    const std::optional<std::size_t> source = source_of(selected, *before.subject);
    const bool same_frame = now->subject->frame.index == before.subject->frame.index;
    const std::uint32_t voxel =
        source && same_frame ? now->subject->voxel_of_source(*source) : planes::kNoVoxel;
    selected.voxel = voxel == planes::kNoVoxel ? -1 : static_cast<std::int32_t>(voxel);
  }
  if (const planes::TraceEvent* event = state.event();
      event && selected.node >= 0 && event->node == selected.node)
    selected.plane = event->plane;
  refresh_matches(state);
}

void add_step_actions(std::vector<Action>& all) {
  const ActionGroup step{all, KeyMode::debugger, "Step", has_run};
  const ActionGroup file{all, KeyMode::debugger, "File", has_run};
  const auto steps = [](const State& s) { return Range{0, s.run()->steps()}; };
  step.add("step.next", "Step forward").key("Right").run([](State& s) { stop_and_step(s, 1); });
  step.add("step.previous", "Step back").key("Left").run([](State& s) { stop_and_step(s, -1); });
  step.add("step.first", "Go to the first step").key("Home").run([](State& s) {
    stop_and_go(s, 0);
  });
  step.add("step.last", "Go to the last step").key("End").run([](State& s) {
    stop_and_go(s, s.run()->steps());
  });
  step.add("step.next_case", "Next node of this case").key("Shift+Right").run([](State& s) {
    to_same_case(s, 1);
  });
  step.add("step.previous_case", "Previous node of this case").key("Shift+Left").run([](State& s) {
    to_same_case(s, -1);
  });
  step.add("step.decision", "Go to the selected node's decision").key("Enter").run(go_to_decision);
  step.add("step.goto", "Go to step").key("G").run(whole("STEP", steps), go_to_step);
  step.add("step.play", "Play")
      .key("L")
      .on([](const State& s) { return s.view.playing.direction > 0; })
      .run([](State& s) { play(s, 1); });
  step.add("step.play_back", "Play backwards")
      .key("J")
      .on([](const State& s) { return s.view.playing.direction < 0; })
      .run([](State& s) { play(s, -1); });
  step.add("step.stop", "Stop playing").key("K").when(nullptr).run([](State& s) {
    s.view.playing.direction = 0;
  });
  const auto is_saving = [](const State& s) { return s.view.saving.has_value(); };
  file.add("steps.save", "Save the steps as APNG")
      .key("Ctrl+E")
      .words("animation export gif video")
      .on(is_saving)
      .run(text(kSaveTakes), save_steps);
  file.add("steps.cancel", "Stop saving the steps")
      .key("Ctrl+Shift+K")
      .when(is_saving)
      .run([](State& s) { s.view.saving->cancelled = true; });
  step.add("step.unit", "Step by event, node, or plane")
      .key("Shift+R")
      .when(nullptr)
      .run(choice<debug::StepUnit>("event|node|plane"),
           [](State& s, debug::StepUnit unit) { s.view.step_unit = unit; });
  step.add("step.rate", "Playing rate")
      .key("R")
      .when(nullptr)
      .run(number("STEPS_PER_SECOND"), [](State& s, double rate) {
        s.view.playing.steps_per_s = std::clamp(rate, 1.0, 100000.0);
      });

  step.add("timeline.zoom_in", "Zoom in on the timeline").key("]").run([](State& s) {
    zoom_by(s, 0.5);
  });
  step.add("timeline.zoom_out", "Zoom out of the timeline").key("[").run([](State& s) {
    zoom_by(s, 2);
  });
  step.add("timeline.phase", "Show the current phase on the timeline")
      .key("Shift+]")
      .run(show_phase);
  step.add("timeline.all", "Show all steps on the timeline").key("Shift+[").run([](State& s) {
    s.view.shown_steps = {0, s.run()->steps()};
  });
  step.add("timeline.range", "Show a range of steps on the timeline")
      .run(Takes<debug::StepRange>{"FIRST-LAST", read_range},
           [](State& s, const debug::StepRange& range) { s.view.shown_steps = range; });
}

// ---- Filter, breakpoints, and running to events ------------------------------------------------

namespace {

void hint_at_filter(State& state) {
  say_hint(state, "no filter is set: type one above the events (Ctrl+F)",
           [](const State& s) { return s.view.search.filter.has_value(); });
}

/// The nearest step before or after the cursor; nullopt if there is none.
std::optional<std::int32_t> next_of(const std::vector<std::int32_t>& steps,
                                    std::int32_t cursor,
                                    int direction) {
  const auto ahead = std::ranges::upper_bound(steps, cursor);
  if (direction > 0) return ahead == steps.end() ? std::nullopt : std::optional(*ahead);
  const auto here = std::ranges::lower_bound(steps, cursor);
  return here == steps.begin() ? std::nullopt : std::optional(*(here - 1));
}

void to_match(State& state, int direction) {
  const Search& search = state.view.search;
  if (!search.filter) return hint_at_filter(state);
  const auto& matches = search.matches;
  if (matches.empty()) return say(state, "no event matches " + search.text);
  // Wrap around at the ends, because a frame opens at its last step.
  const auto next = next_of(matches, state.view.step, direction);
  if (!next)
    say(state, direction > 0 ? "no later event matches; continued from the beginning"
                             : "no earlier event matches; continued from the end");
  stop_and_go(state, next.value_or(direction > 0 ? matches.front() : matches.back()));
}

void run_to(State& state, int direction) {
  const debug::Run& run = *state.run();
  const auto next =
      next_of(breakpoint_steps(run, state.document.breakpoints), state.view.step, direction);
  stop_and_go(state, next.value_or(direction > 0 ? run.steps() : 0));
  if (!next)
    say(state, direction > 0 ? "no breakpoint ahead: ran to the end"
                             : "no breakpoint behind: ran back to the beginning");
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

std::vector<std::int32_t> breakpoint_steps(const debug::Run& run,
                                           const std::vector<Breakpoint>& all,
                                           bool enabled) {
  std::vector<std::int32_t> stops;
  for (const Breakpoint& breakpoint : all) {
    if (breakpoint.enabled != enabled) continue;
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
    if (s.view.selected.node < 0) return hint_at_node(s);
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
