// Moving through the trace.

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "core/debug/replay/steps.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

void stop_and_go(State& state, std::int32_t step) {
  state.view.playing.direction = 0;
  go_to_step(state, step);
}

void stop_and_step(State& state, int count) {
  state.view.playing.direction = 0;
  step_by(state, count);
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
    const std::int32_t from = state.view.step;
    stop_and_go(state, step);
    return color_traversal(state, from);
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

constexpr int kMostPictures = 500;  // where nobody says how many steps apart
constexpr const char* kSaveTakes = "PATH.png [FROM-TO [EVERY [PICTURES_PER_SECOND]]]";

[[noreturn]] void refuse_saving(const std::string& text) {
  throw Error("action steps.save: '" + text + "' is not as expected, " + kSaveTakes);
}

/// Behind the path, which may have spaces: "200-600 2 12".
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

/// From the cursor to the end; from there, all of them.
void save_steps(State& state, const std::string& text) {
  std::size_t end = std::string::npos;
  for (const std::string ending : {".png", ".apng"})
    for (std::size_t at = text.find(ending); at != std::string::npos;
         at = text.find(ending, at + 1))
      if (const std::size_t after = at + ending.size(); after == text.size() || text[after] == ' ')
        end = std::min(end, after);
  if (end == std::string::npos)
    throw Error("action steps.save: '" + text + "' is no PNG, expected a name.png");
  if (state.view.saving) throw Error("action steps.save: steps are being written, Esc stops that");
  const std::int32_t steps = state.run()->steps(), at = state.view.step;
  StepsSaving saving{.path = text.substr(0, end),
                     .run = state.results.current ? state.results.current->run : nullptr,
                     .first = at < steps ? at : 0,
                     .last = steps};
  if (state.view.flash && state.results.pinned) saving.run = state.results.pinned->run;
  read_steps(text, words_of(text.substr(end)), saving);
  std::error_code failed;
  const std::filesystem::path folder = std::filesystem::absolute(saving.path).parent_path();
  if (!std::filesystem::is_directory(folder, failed))
    throw Error(saving.path.string() + ": cannot be written, " + folder.string() +
                " is not a folder");
  if (std::filesystem::is_directory(saving.path, failed))
    throw Error(saving.path.string() + ": cannot be written, it is a folder");
  say(state, "");
  state.view.saving = saving;
}

const std::vector<std::string> kUnits = {"event", "node", "plane"};

}  // namespace

void color_traversal(State& state, std::int32_t from) {
  ViewState& view = state.view;
  const debug::StepRange traversal = debug::traversal_of(*state.run());
  const bool steps_back_in = from > traversal.last && traversal.contains(view.step);
  if (!steps_back_in || view.case_colors != CaseColors::ready ||
      view.color_by != render::ColorBy::planes)
    return;
  view.case_colors = CaseColors::shown;
  view.color_by = render::ColorBy::cases;
  say_hint(state, "colored by case while you step back; press 2 to color by plane",
           [](const State& now) { return now.view.case_colors != CaseColors::shown; });
}

void step_by(State& state, int count) {
  const std::int32_t from = state.view.step;
  go_to_step(state, debug::step_from(*state.run(), state.view.step_unit, from, count));
  if (count < 0) color_traversal(state, from);
}

std::vector<Action> step_actions() {
  const std::string menu = "Step";
  return {
      {"step.next",
       "Step forward",
       menu,
       "Right",
       "",
       [](State& s, const std::string&) { stop_and_step(s, 1); },
       has_run,
       {}},
      {"step.previous",
       "Step back",
       menu,
       "Left",
       "",
       [](State& s, const std::string&) { stop_and_step(s, -1); },
       has_run,
       {}},
      {"step.first",
       "To the beginning",
       menu,
       "Home",
       "",
       [](State& s, const std::string&) { stop_and_go(s, 0); },
       has_run,
       {}},
      {"step.last",
       "To the end",
       menu,
       "End",
       "",
       [](State& s, const std::string&) { stop_and_go(s, s.run()->steps()); },
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
         if (selected.node < 0)
           return say_hint(s, "no node is selected: click its box or its row in the tree",
                           [](const State& now) { return now.view.selected.node >= 0; });
         const std::int32_t step = decided[static_cast<std::size_t>(selected.node)];
         if (step == planes::kNever) return say(s, "the selected node was never decided");
         go_to_step(s, step);
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
      {"steps.save", "Save the steps as APNG", "File", "Ctrl+E", kSaveTakes, save_steps, has_run,
       [](const State& s) { return s.view.saving.has_value(); }},
      {"steps.cancel",
       "Stop saving the steps",
       "File",
       "Ctrl+Shift+K",
       "",
       [](State& s, const std::string&) { s.view.saving->cancelled = true; },
       [](const State& s) { return s.view.saving.has_value(); },
       {}},
      {"step.unit",
       "Step by event, node or plane",
       menu,
       "Shift+R",
       "event|node|plane",
       [](State& s, const std::string& text) {
         s.view.step_unit =
             static_cast<debug::StepUnit>(choice_argument("step.unit", text, kUnits));
       },
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
