#include "app/desktop/jobs/learn_jobs.hpp"

#include <fmt/format.h>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

bool is_shown(const State& state, const std::shared_ptr<const io::Recording>& recording) {
  return state.document.current() && state.document.current()->recording == recording;
}

/// What is found from now on is found with the weights that were trained.
void take_weights(State& state, const LearningSource& source) {
  const std::string done =
      fmt::format("classifier trained on {}", counted(source.reviewed.size(), "reviewed frame"));
  if (!is_shown(state, source.recording)) return say(state, done);
  planes::PipelineOptions after = state.document.options;
  after.classifier = learnt_weights(source.label_dir).string();
  change_options(state, after);
  say(state, done + "; planes now use it");
}

}  // namespace

LearnJobs::LearnJobs(std::function<void(std::function<void(State&)>)> deliver,
                     std::function<void()> wake)
    : deliver_(std::move(deliver)),
      training_(wake, [](const std::string&) {}),  // each tells by itself what went wrong
      measuring_(wake, [](const std::string&) {}),
      doubting_(wake, [](const std::string&) {}) {}

LearnJobs::~LearnJobs() {
  for (Worker* worker : {&training_, &measuring_, &doubting_}) worker->cancel();
}

void LearnJobs::pursue(State& state) {
  if (!state.document.current()) return;
  pursue_training(state);
  pursue_measuring(state);
  pursue_doubt(state);
}

bool LearnJobs::busy() const { return training_.busy() || measuring_.busy() || doubting_.busy(); }

LearningProgress LearnJobs::training_progress(int number, std::stop_token stop) {
  return [this, number, stop = std::move(stop)](const char* stage, int done, int all) {
    if (stop.stop_requested()) throw Cancelled();
    deliver_([=, this](State& s) {
      if (number != training_number_) return;
      Learning::Training& training = s.results.label.learning.training;
      training.stage = stage;
      training.done = done;
      training.total = all;
    });
  };
}

void LearnJobs::pursue_training(State& state) {
  Learning::Training& training = state.results.label.learning.training;
  if (training_asked_ && !training.running) {  // called off
    training_.cancel();
    training_asked_ = false;
    ++training_number_;
  }
  if (!training.running || training.begun) return;
  training.begun = training_asked_ = true;
  const int number = ++training_number_;
  training_.cancel();  // one that was called off and begun anew before it was seen
  training_.replace([this, number, source = learning_source(state),
                     lesson = training.lesson](std::stop_token stop) {
    const auto finish = [&](std::function<void(State&)> with) {
      deliver_([this, number, with = std::move(with)](State& s) {
        if (number != training_number_) return;
        training_asked_ = false;
        s.results.label.learning.training = {};
        with(s);
      });
    };
    try {
      learn(source, lesson, training_progress(number, std::move(stop)));
      finish([this, source](State& s) {
        ++trainings_;
        take_weights(s, source);
      });
    } catch (const Cancelled&) {
      // Whoever called it off has said so.
    } catch (const std::exception& error) {
      finish([message = message_of(error)](State& s) { say(s, message, true); });
    }
  });
}

void LearnJobs::pursue_measuring(State& state) {
  if (state.view.mode != Mode::labels || state.view.label.tab != "learning") return;
  const LearningSource source = learning_source(state);
  const Measured wanted{source.recording, source.reviewed, trainings_};
  if (wanted == measured_) return;
  if (wanted.recording != measured_.recording) {
    state.results.label.learning.learnt = nullptr;
    state.results.label.learning.refusal.clear();
  }
  measured_ = wanted;
  measuring_.cancel();
  measuring_.replace([this, wanted, source](std::stop_token stop) {
    std::shared_ptr<const Learnt> learnt;
    std::string refusal;
    try {
      learnt = measure_learnt(source, [&](const char*, int, int) {
        if (stop.stop_requested()) throw Cancelled();
      });
    } catch (const Cancelled&) {
      return;
    } catch (const std::exception& error) {
      refusal = message_of(error);
    }
    deliver_([this, wanted, learnt, refusal](State& s) {
      if (wanted != measured_) return;
      s.results.label.learning.learnt = learnt;
      s.results.label.learning.refusal = refusal;
    });
  });
}

void LearnJobs::pursue_doubt(State& state) {
  Learning::Doubt& doubt = state.results.label.learning.doubt;
  const Wanted wanted = wanted_of(state.document, 0);
  if (doubted_ &&
      (!doubted_->recording || doubted_->recording != wanted.recording ||
       doubted_->prepare_key != wanted.prepare_key || !(doubted_->picked == wanted.picked))) {
    const bool wants_more = doubt.running && !doubt.begun;
    doubting_.cancel();  // of another classifier or recording: no longer true
    ++doubt_number_;
    doubted_.reset();
    doubt = {};
    doubt.running = wants_more;
  }
  if (!doubt.running || doubt.begun) return;
  doubt.begun = true;
  doubted_ = wanted;
  const auto count = static_cast<std::size_t>(wanted.recording->frame_count());
  doubt.of_frame.assign(count, std::nullopt);
  std::vector<std::uint8_t> wants(count);
  for (std::size_t i = 0; i < count; ++i)
    wants[i] = !frame_mark(state, static_cast<int>(i)).reviewed;
  doubting_.replace([this, number = ++doubt_number_, wanted = wanted,
                     wants = std::move(wants)](std::stop_token stop) mutable {
    for (std::size_t i = 0; i < wants.size(); ++i) {
      if (!wants[i]) continue;
      if (stop.stop_requested()) return;
      wanted.frame = static_cast<int>(i);
      // The objective asks no classifier about depth images.
      wanted.options.segment = planes::profile_options(planes::Profile::paper);
      std::optional<double> share;
      try {
        std::string refused_labels;
        share = doubt_of(*load_subject(wanted, tools_, &refused_labels));
      } catch (const std::exception&) {
        // A frame that cannot be read says why where it is opened.
      }
      deliver_([this, number, i, share](State& s) {
        if (number != doubt_number_) return;
        s.results.label.learning.doubt.of_frame[i] = share;
        ++s.results.label.learning.doubt.done;
      });
    }
    deliver_([this, number](State& s) {
      if (number != doubt_number_) return;
      s.results.label.learning.doubt.running = false;
      if (s.view.mode != Mode::labels || !can_label(s)) return;
      try {
        apply(s, {"label.next.doubtful", ""});
      } catch (const Error& error) {
        say(s, error.what(), true);
      }
    });
  });
}

}  // namespace planescope::desktop
