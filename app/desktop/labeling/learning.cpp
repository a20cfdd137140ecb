// Trains and evaluates a classifier on reviewed frames, and ranks frames by doubt.

#include "app/desktop/labeling/learning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/commands/train.hpp"
#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

constexpr float kSureMargin = 0.5f;  // difference between the two probabilities: 75 % against 25 %

std::filesystem::path shipped_weights() {
  return app::find_asset("classifier.safetensors", "the initial weights are");
}

/// Reads the reviewed frames as training data.
std::vector<app::LabeledFrame> read_reviewed(const LearningSource& source,
                                             const LearningProgress& progress) {
  std::vector<app::LabeledFrame> frames;
  const world::SequenceGravity gravity(source.recording, source.options.gravity);
  int done = 0;
  for (const int index : source.reviewed) {
    progress("reviewed frames", done++, static_cast<int>(source.reviewed.size()));
    Frame frame = source.recording->frame(index);
    gravity.resolve(frame, source.picked);
    const std::string hash = source.recording->frame_hash(index);
    const auto truth = labels::frame_truth(frame, source.label_dir, hash);
    if (!truth) continue;
    try {
      frames.push_back(app::make_labeled_frame(frame, *truth, hash, source.options));
    } catch (const Error& error) {
      throw Error(fmt::format("frame {}: {}", index, error.what()));
    }
  }
  return frames;
}

Gain gain_on(const std::vector<planes::LabeledCloud>& clouds,
             const planes::NetworkWeights& before,
             const planes::NetworkWeights& after,
             int threads) {
  return {clouds.size(), lab::score_network(before, clouds, threads),
          lab::score_network(after, clouds, threads)};
}

}  // namespace

std::filesystem::path learnt_weights(const std::filesystem::path& label_dir) {
  return label_dir / "classifier.safetensors";
}

LearningSource learning_source(const State& state) {
  const OpenRecording& open = *state.document.current();
  LearningSource source{open.recording, open.picked, open.label_dir, {}, state.document.options};
  for (int i = 0; i < open.recording->frame_count(); ++i)
    if (frame_mark(state, i).reviewed && !(open.labels && open.labels->unsaved(i)))
      source.reviewed.push_back(i);
  return source;
}

void learn(const LearningSource& source, const Lesson& lesson, const LearningProgress& progress) {
  app::LabeledRecordings frames = app::labeled_recordings(read_reviewed(source, progress));
  if (frames.train.empty()) throw Error("no reviewed frame has labeled points");
  app::TrainArgs args;
  args.input.pipeline = source.options;
  app::begin_with(args, shipped_weights());
  args.recipe.train.steps = lesson.steps;
  app::limit_clouds(args.recipe, lesson.clouds, &args.validation_clouds);
  const planes::NetworkWeights weights = app::teach(args, std::move(frames), progress);
  progress("weights", 1, 1);  // last chance to stop
  planes::write_weights(learnt_weights(source.label_dir), weights);
}

std::shared_ptr<const Learnt> measure_learnt(const LearningSource& source,
                                             const LearningProgress& progress) {
  const std::filesystem::path file = learnt_weights(source.label_dir);
  if (!std::filesystem::exists(file)) return nullptr;
  const planes::NetworkWeights after = planes::read_weights(file);
  const auto record = nlohmann::json::parse(after.training, nullptr, false);
  auto learnt = std::make_shared<Learnt>();
  std::vector<std::string> known;
  try {
    learnt->steps = record.at("steps").get<int>();
    known = record.at("frames").get<std::vector<std::string>>();
  } catch (const std::exception&) {
    throw Error(
        file.string() +
        ": contains no record of its training frames; expected weights trained in this window");
  }
  learnt->frames = known.size();
  std::vector<planes::LabeledCloud> kept, since;
  for (app::LabeledFrame& frame : read_reviewed(source, progress)) {
    if (frame.cloud.points.empty()) continue;  // nothing to score
    const auto at = std::ranges::find(known, frame.sha256);
    if (at == known.end())
      since.push_back(std::move(frame.cloud));
    else if (app::is_kept_for_validation(static_cast<std::size_t>(at - known.begin())))
      kept.push_back(std::move(frame.cloud));
  }
  const planes::NetworkWeights before = planes::read_weights(shipped_weights());
  learnt->kept = gain_on(kept, before, after, source.options.threads);
  learnt->since = gain_on(since, before, after, source.options.threads);
  return learnt;
}

std::optional<double> doubt_of(const debug::Subject& subject) {
  const planes::Classification& labels = subject.prepared.classification;
  if (labels.margins.empty() || std::ranges::count(labels.labels, Label::unknown) ==
                                    static_cast<std::ptrdiff_t>(labels.labels.size()))
    return std::nullopt;
  const auto unsure =
      std::ranges::count_if(labels.margins, [](float margin) { return margin < kSureMargin; });
  return static_cast<double>(unsure) / static_cast<double>(labels.margins.size());
}

std::vector<int> by_doubt(const State& state) {
  const std::vector<std::optional<double>>& doubt = state.results.label.learning.doubt.of_frame;
  std::vector<int> frames;
  for (std::size_t i = 0; i < doubt.size(); ++i)
    if (doubt[i] && !frame_mark(state, static_cast<int>(i)).reviewed)
      frames.push_back(static_cast<int>(i));
  std::ranges::stable_sort(frames, std::greater(),
                           [&](int i) { return *doubt[static_cast<std::size_t>(i)]; });
  return frames;
}

// ---- Actions -----------------------------------------------------------------------------------

namespace {

Learning& learning(State& state) { return state.results.label.learning; }

/// "[STEPS [CLOUDS]]".
Lesson read_lesson(const State&, const std::string& action, const std::string& text) {
  constexpr int kMost = 1'000'000;
  Lesson lesson;
  const std::vector<std::string> words = words_of(text);
  if (words.size() > 2)
    throw Error(
        fmt::format("action label.learn: invalid argument '{}'; expected [STEPS [CLOUDS]]", text));
  if (!words.empty()) lesson.steps = whole_argument(action, words[0], 1, kMost);
  if (words.size() > 1) lesson.clouds = whole_argument(action, words[1], 1, kMost);
  return lesson;
}

void begin_training(State& state, const Lesson& lesson) {
  const OpenRecording& open = *state.document.current();
  state.view.label.tab = "learning";
  if (learning(state).training.running) throw Error("training is already running");
  if (open.labels && !open.labels->read_only().empty()) throw Error(open.labels->read_only());
  save_labels(state);
  const std::size_t reviewed = learning_source(state).reviewed.size();
  if (reviewed == 0) throw Error("no frame is marked as reviewed; press Shift+D to mark one");
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

}  // namespace

void show_doubtful_frame(State& state) {
  Learning::Doubt& doubt = learning(state).doubt;
  if (doubt.of_frame.empty()) {
    if (state.document.options.classifier == "truth")
      throw Error("ground-truth labels have no confidence; choose a different classifier");
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
  show_frame(state, next);
  say(state, fmt::format("frame {}: {:.1f} % of its points are doubtful", next,
                         100 * *doubt.of_frame[static_cast<std::size_t>(next)]));
}

void add_learning_actions(std::vector<Action>& all) {
  const ActionGroup learn{all, KeyMode::labels, "Labels", can_label};
  learn.add("label.learn", "Train the classifier on reviewed frames")
      .key("Ctrl+Shift+L")
      .run(Takes<Lesson>{"[STEPS [CLOUDS]]", read_lesson}, begin_training);
  learn.add("label.learn.stop", "Stop training")
      .key("Ctrl+Shift+X")
      .when([](const State& s) { return s.results.label.learning.training.running; })
      .run(stop_training);
  learn.add("label.next.doubtful", "Next doubtful frame").key("Shift+Y").run(show_doubtful_frame);
}

}  // namespace planescope::desktop
