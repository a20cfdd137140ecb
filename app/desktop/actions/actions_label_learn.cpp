// A classifier that learns from what was reviewed, and the frames that it is in doubt about.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/learning.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

Learning& learning(State& state) { return state.results.label.learning; }

/// "[STEPS [CLOUDS]]".
Lesson lesson_argument(const std::string& text) {
  constexpr int kMost = 1'000'000;
  Lesson lesson;
  const std::vector<std::string> words = words_of(text);
  if (words.size() > 2)
    throw Error(fmt::format("action label.learn: '{}', expected [STEPS [CLOUDS]]", text));
  if (!words.empty()) lesson.steps = whole_argument("label.learn", words[0], 1, kMost);
  if (words.size() > 1) lesson.clouds = whole_argument("label.learn", words[1], 1, kMost);
  return lesson;
}

void begin_training(State& state, const std::string& text) {
  const Lesson lesson = lesson_argument(text);
  const OpenRecording& open = *state.document.current();
  state.view.label.tab = "learning";
  if (learning(state).training.running) throw Error("training is already running");
  if (open.labels && !open.labels->read_only().empty()) throw Error(open.labels->read_only());
  save_labels(state);
  const std::size_t reviewed = learning_source(state).reviewed.size();
  if (reviewed == 0) throw Error("no frame is reviewed: Shift+D marks a frame to learn from");
  Learning::Training& training = learning(state).training;
  training = {};
  training.running = true;
  training.lesson = lesson;
  say(state, fmt::format("training on {}", counted(reviewed, "reviewed frame")));
}

void stop_training(State& state) {
  learning(state).training = {};
  say(state, "training stopped; the classifier is unchanged");
}

/// The frame after this one in the order of doubt; where this one has no place in it, the first.
void show_doubtful(State& state) {
  Learning::Doubt& doubt = learning(state).doubt;
  if (doubt.of_frame.empty()) {
    if (state.document.options.classifier == "truth")
      throw Error("ground truth labels have no confidence: choose another classifier");
    doubt.running = true;
    return say(state, "searching for doubtful frames");
  }
  if (doubt.running) return say_nothing_done(state, "still searching for doubtful frames");
  if (std::ranges::none_of(doubt.of_frame, [](const auto& share) { return share.has_value(); }))
    return say_nothing_done(state, "the classifier has no confidences for these frames");
  const std::vector<int> frames = by_doubt(state);
  const auto here = std::ranges::find(frames, state.document.frame);
  if (frames.empty() || (frames.size() == 1 && here != frames.end()))
    return say_nothing_done(state, "no other frame to review");
  const int next = here == frames.end() || here + 1 == frames.end() ? frames.front() : here[1];
  apply(state, {"frame.show", std::to_string(next)});
  say(state, fmt::format("frame {}: {:.1f} % of its points are doubtful", next,
                         100 * *doubt.of_frame[static_cast<std::size_t>(next)]));
}

}  // namespace

std::vector<Action> label_learn_actions() {
  const auto is_training = [](const State& s) { return s.results.label.learning.training.running; };
  return {
      {"label.learn",
       "Train the classifier on reviewed frames",
       "Labels",
       "Ctrl+Shift+L",
       "[STEPS [CLOUDS]]",
       begin_training,
       can_label,
       {}},
      {"label.learn.stop",
       "Stop training",
       "Labels",
       "Ctrl+Shift+X",
       "",
       [](State& s, const std::string&) { stop_training(s); },
       is_training,
       {}},
      {"label.next.doubtful",
       "Next doubtful frame",
       "Labels",
       "Shift+Y",
       "",
       [](State& s, const std::string&) { show_doubtful(s); },
       can_label,
       {}},
  };
}

}  // namespace planescope::desktop
