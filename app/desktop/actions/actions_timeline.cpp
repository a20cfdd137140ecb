// Which steps the timeline shows.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/debugger/step_axis.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

constexpr double kZoomStep = 2;

/// About the cursor if it is shown, else about the middle.
void zoom_by(State& state, double factor) {
  const debug::StepRange shown = shown_steps(state);
  const std::int32_t cursor = state.view.step;
  const std::int32_t about = shown.contains(cursor) ? cursor : shown.first + shown.count() / 2;
  state.view.shown_steps = zoomed(shown, about, factor, state.run()->steps());
}

/// Shows the phase that the cursor is in. The first one begins before its first event.
void show_phase(State& state) {
  for (const debug::Phase& phase : debug::phases_of(*state.run())) {
    if (phase.steps.last < state.view.step) continue;
    const std::int32_t first = phase.steps.first == 1 ? 0 : phase.steps.first;
    state.view.shown_steps = {first, phase.steps.last};
    return;
  }
}

void show_range(State& state, const std::string& text) {
  const std::vector<std::string> ends = split(text, '-');
  if (ends.size() != 2)
    throw Error(fmt::format("action timeline.range: '{}' is no range, expected FIRST-LAST", text));
  const int first = whole_argument("timeline.range", ends[0], 0, state.run()->steps());
  state.view.shown_steps = {first,
                            whole_argument("timeline.range", ends[1], first, state.run()->steps())};
}

}  // namespace

std::vector<Action> timeline_actions() {
  const std::string menu = "Step";
  return {
      {"timeline.zoom_in",
       "Zoom in on the timeline",
       menu,
       "]",
       "",
       [](State& s, const std::string&) { zoom_by(s, 1 / kZoomStep); },
       has_run,
       {}},
      {"timeline.zoom_out",
       "Zoom out of the timeline",
       menu,
       "[",
       "",
       [](State& s, const std::string&) { zoom_by(s, kZoomStep); },
       has_run,
       {}},
      {"timeline.phase",
       "Show the current phase on the timeline",
       menu,
       "Shift+]",
       "",
       [](State& s, const std::string&) { show_phase(s); },
       has_run,
       {}},
      {"timeline.all",
       "Show all steps on the timeline",
       menu,
       "Shift+[",
       "",
       [](State& s, const std::string&) {
         s.view.shown_steps = {0, s.run()->steps()};
       },
       has_run,
       {}},
      {"timeline.range",
       "Show a range of steps on the timeline",
       "",
       "",
       "FIRST-LAST",
       show_range,
       has_run,
       {}},
  };
}

}  // namespace planescope::desktop
