// Moving through the trace.

#include <algorithm>

#include "app/desktop/actions/actions.hpp"

namespace planescope::desktop {
namespace {

void step_by(State& state, int by) {
  state.view.playing.direction = 0;
  go_to_step(state, state.view.step + by);
}

/// The case of the node that was decided at the step, or else last before it.
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
    state.view.playing.direction = 0;
    go_to_step(state, step);
    return;
  }
  say(state, std::string("no ") + (direction > 0 ? "later" : "earlier") + " node of case " +
                 planes::to_string(wanted));
}

void play(State& state, int direction) {
  Playing& playing = state.view.playing;
  playing.direction = playing.direction == direction ? 0 : direction;
  playing.due = 0;
  if (playing.direction > 0 && state.view.step == state.run()->steps()) go_to_step(state, 0);
}

}  // namespace

std::vector<Action> step_actions() {
  const std::string menu = "Step";
  return {
      {"step.next",
       "Step forward",
       menu,
       "Right",
       "",
       [](State& s, const std::string&) { step_by(s, 1); },
       has_run,
       {}},
      {"step.previous",
       "Step back",
       menu,
       "Left",
       "",
       [](State& s, const std::string&) { step_by(s, -1); },
       has_run,
       {}},
      {"step.first",
       "To the beginning",
       menu,
       "Home",
       "",
       [](State& s, const std::string&) { step_by(s, -s.view.step); },
       has_run,
       {}},
      {"step.last",
       "To the end",
       menu,
       "End",
       "",
       [](State& s, const std::string&) { step_by(s, s.run()->steps()); },
       has_run,
       {}},
      {"step.next_case",
       "Next node of this case",
       menu,
       "Shift+Right",
       "",
       [](State& s, const std::string&) { to_same_case(s, 1); },
       has_run,
       {}},
      {"step.previous_case",
       "Previous node of this case",
       menu,
       "Shift+Left",
       "",
       [](State& s, const std::string&) { to_same_case(s, -1); },
       has_run,
       {}},
      {"step.decision",
       "To the decision of the selected node",
       menu,
       "Enter",
       "",
       [](State& s, const std::string&) {
         const Selection selected = s.view.selected;
         const auto decided = s.run()->timeline.decided_at();
         if (selected.node < 0 ||
             decided[static_cast<std::size_t>(selected.node)] == planes::kNever)
           return say(s, "no node is selected");
         go_to_step(s, decided[static_cast<std::size_t>(selected.node)]);
       },
       has_run,
       {}},
      {"step.goto",
       "Go to step",
       menu,
       "G",
       "STEP",
       [](State& s, const std::string& text) {
         go_to_step(s, whole_argument("step.goto", text, 0, s.run()->steps()));
       },
       has_run,
       {}},
      {"step.play", "Play", menu, "L", "", [](State& s, const std::string&) { play(s, 1); },
       has_run, [](const State& s) { return s.view.playing.direction > 0; }},
      {"step.play_back", "Play backwards", menu, "J", "",
       [](State& s, const std::string&) { play(s, -1); }, has_run,
       [](const State& s) { return s.view.playing.direction < 0; }},
      {"step.stop",
       "Stop playing",
       menu,
       "K",
       "",
       [](State& s, const std::string&) { s.view.playing.direction = 0; },
       {},
       {}},
      {"step.rate",
       "Playing rate",
       menu,
       "R",
       "STEPS_PER_SECOND",
       [](State& s, const std::string& text) {
         s.view.playing.steps_per_s = std::clamp(number_argument("step.rate", text), 1.0, 100000.0);
       },
       {},
       {}},
  };
}

}  // namespace planescope::desktop
