#include "app/commands/train.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "app/output.hpp"
#include "app/progress.hpp"
#include "core/base/error.hpp"
#include "core/base/file_bytes.hpp"
#include "core/base/sha256.hpp"
#include "core/classify/checkpoint.hpp"
#include "core/pipeline/labelled_frame.hpp"
#include "core/report/build_info.hpp"
#include "core/report/training_page.hpp"
#include "core/synthetic/counter_random.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uint64_t kValidationSeed = 900001;  // no set that is trained on has it
constexpr int kValidationClouds = 12;              // of each kind
constexpr std::uint64_t kFromRecording = 201;      // a stream of random numbers
constexpr double kRecordingShare = 0.5;            // of the clouds seen, where there are both

/// The frames of the inputs that have truth; every fifth of them is kept for validation.
struct RecordingSet {
  std::vector<LabelledCloud> train, validation;
};

RecordingSet load_recordings(const InputArgs& args, const std::stop_token& stop) {
  RecordingSet set;
  if (args.inputs.empty()) return set;
  int labelled = 0;
  for (const OpenInput& input : open_inputs(args))
    for (const int index : input.frames) {
      if (stop.stop_requested()) throw Cancelled();
      if (!may_have_truth(input, index)) continue;
      const Frame frame = input.recording->frame(index);
      const auto truth = frame_truth(frame, input.label_dir, input.recording->frame_hash(index));
      if (!truth) continue;
      LabelledCloud cloud = labelled_frame(frame, args.pipeline, *truth);
      (++labelled % 5 == 0 ? set.validation : set.train).push_back(std::move(cloud));
    }
  if (labelled == 0)
    throw Error(args.inputs[0].string() +
                ": has no labelled frame to learn from, expected label files (--labels DIR)");
  return set;
}

/// All that a training needs beside its state.
struct Training {
  const TrainArgs& args;
  std::vector<LabelledCloud> synthetic;
  RecordingSet recordings;
  std::vector<ValidationSet> validation;

  LabelledCloud draw(std::uint64_t number) const {
    const TrainingRecipe& recipe = args.recipe;
    const double from_recording = random_uniform(recipe.train.seed, kFromRecording, number);
    const double share = !args.synthetic ? 1 : recordings.train.empty() ? 0 : kRecordingShare;
    if (from_recording >= share) return draw_cloud(recipe, synthetic, number);
    const std::uint64_t bits = random_bits(recipe.train.seed, kFromRecording + 1, number);
    return augment(recordings.train[bits % recordings.train.size()], recipe.scans, bits);
  }
};

Training prepare(const TrainArgs& args, const std::stop_token& stop) {
  Training training{args, {}, load_recordings(args.input, stop), {}};
  const int threads = args.input.pipeline.threads;
  if (args.synthetic) {
    Progress bar("training set", args.recipe.set.count());
    training.synthetic = make_training_set(args.recipe.set, threads, [&](int done, int) {
      if (stop.stop_requested()) throw Cancelled();
      bar.show(done, "clouds");
    });
  }
  training.validation = make_validation_sets(kValidationSeed, kValidationClouds, threads);
  if (!training.recordings.validation.empty())
    training.validation.push_back({"recordings", training.recordings.validation});
  return training;
}

/// What a checkpoint must agree with beyond the trainer's own options.
std::string purpose(const TrainArgs& args) {
  std::vector<std::string> inputs;
  for (const fs::path& input : args.input.inputs) inputs.push_back(input.string());
  return fmt::format("recipe {}, synthetic {}, from '{}', recordings '{}'", args.recipe.name,
                     args.synthetic, args.from.string(), fmt::join(inputs, "' '"));
}

Json record_of(const Training& training, const TrainState& state) {
  const TrainArgs& args = training.args;
  const TrainOptions& options = args.recipe.train;
  Json record = {{"recipe", args.recipe.name},
                 {"seed", options.seed},
                 {"steps", state.step},
                 {"batch", options.batch},
                 {"learning_rate", options.learning_rate},
                 {"edge_weight", options.edge_weight},
                 {"balance_classes", options.balance_classes},
                 {"synthetic_clouds", training.synthetic.size()},
                 {"recordings", training.recordings.train.size()},
                 {"from", args.from.empty() ? "" : sha256_hex_of_file(args.from)},
                 {"planescope", PLANESCOPE_VERSION}};
  if (!state.epochs.empty()) {
    record["loss"] = state.epochs.back().train_loss;
    for (std::size_t s = 0; s < training.validation.size(); ++s) {
      const LabelAccuracy& a = state.epochs.back().validation[s];
      record["validation"][training.validation[s].name] = {{"edge", a.edge_percent()},
                                                           {"inner", a.inner_percent()}};
    }
  }
  return record;
}

void write_page(const Training& training, const TrainState& state, const fs::path& path) {
  const TrainOptions& options = training.args.recipe.train;
  TrainingSummary summary;
  summary.title = "Training of " + training.args.out.filename().string();
  summary.facts = {
      {"Command", training.args.command},
      {"Recipe", training.args.recipe.name},
      {"Network",
       fmt::format("{}, {} parameters", options.network.name, parameter_count(options.network))},
      {"Steps", fmt::format("{} of {}", state.step, options.steps)},
      {"Seed", fmt::format("{}", options.seed)},
      {"Clouds", fmt::format("{} synthetic, {} of recordings", training.synthetic.size(),
                             training.recordings.train.size())}};
  for (const ValidationSet& set : training.validation) summary.validation_sets.push_back(set.name);
  summary.epochs = state.epochs;
  const std::string text = training_page(summary);
  write_file_bytes(path, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

std::string minutes(double seconds) {
  const int whole = static_cast<int>(seconds);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

void validate(const Training& training, TrainState& state) {
  Epoch& epoch = state.epochs.emplace_back();
  const TrainOptions& options = training.args.recipe.train;
  const int steps = state.step - (state.epochs.size() > 1 ? state.epochs.end()[-2].step : 0);
  epoch.step = state.step;
  epoch.train_loss = state.loss_sum / std::max(1, steps);
  state.loss_sum = 0;
  std::string line = fmt::format("step {:>6} of {}, loss {:.4f}, edge", epoch.step, options.steps,
                                 epoch.train_loss);
  for (const ValidationSet& set : training.validation) {
    epoch.validation.push_back(
        score_network(state.weights, set.clouds, training.args.input.pipeline.threads));
    line += fmt::format("  {:.1f}", epoch.validation.back().edge_percent());
  }
  fmt::print(stderr, "{}{}\n", isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", line);
}

}  // namespace

int run_train(const TrainArgs& args, std::stop_token stop) {
  const fs::path page = fs::path(args.out).replace_extension(".html");
  const fs::path checkpoint = fs::path(args.out).replace_extension(".checkpoint");
  check_output_dir(args.out.has_parent_path() ? args.out.parent_path() : fs::path("."));
  const TrainOptions& options = args.recipe.train;

  TrainState state =
      args.resume ? read_checkpoint(checkpoint, options, purpose(args)) : begin_training(options);
  if (!args.from.empty() && !args.resume) {
    NetworkWeights from = read_weights(args.from);
    if (!(from.config == options.network))
      throw Error(fmt::format("{}: is a {} network, expected {} (--network)", args.from.string(),
                              from.config.name, options.network.name));
    state.weights.tensors = std::move(from.tensors);
  }
  const Training training = prepare(args, stop);
  const auto save = [&] {
    write_checkpoint(checkpoint, state, options, purpose(args));
    write_page(training, state, page);
  };

  const auto started = std::chrono::steady_clock::now();
  const int first = state.step;
  {
    Progress bar("train", options.steps);
    while (state.step < options.steps) {
      if (stop.stop_requested()) {
        save();
        fmt::print(stderr, "\nstopped at step {}; the same command with --resume goes on from {}\n",
                   state.step, checkpoint.string());
        throw Cancelled();
      }
      train_step(
          state, options, [&](std::uint64_t n) { return training.draw(n); },
          args.input.pipeline.threads);
      if (state.step % options.epoch_steps == 0 || state.step == options.steps) {
        validate(training, state);
        save();
      }
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - started;
      bar.show(state.step,
               fmt::format("steps, {} left", minutes(spent.count() / (state.step - first) *
                                                     (options.steps - state.step))));
    }
  }
  state.weights.training = record_of(training, state).dump();
  write_weights(args.out, state.weights);
  write_page(training, state, page);
  std::error_code ignored;
  fs::remove(checkpoint, ignored);
  fmt::print("{}: {} parameters, trained in {} steps; curves in {}\n", args.out.string(),
             parameter_count(options.network), state.step, page.string());
  return 0;
}

}  // namespace planescope
