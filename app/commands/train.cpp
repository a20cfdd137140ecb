// Classifier training: options, checkpoints, progress and the final accuracy check.

#include "app/commands/train.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

// Factor on the learning rate when trained weights are trained further. Measured with 200 steps on
// five frames of another camera resolution plus the synthetic set: new frames of that camera gain
// 0.7 points near edges and the validation sets lose nothing; at the full rate the frames gain
// nothing and the stairs lose 0.4.
constexpr double kFineTuningRate = 0.25;
// Margin in percentage points before the baseline counts as better: trainings that differ only in
// their seed differ by this much.
constexpr double kTolerance = 0.3;

constexpr std::string_view kResume = " --resume";

struct Files {
  fs::path weights, page, checkpoint;
};

/// Throws Error if the output files would not be writable at the end, or if the checkpoint of
/// another training would be lost.
Files checked_files(const TrainArgs& args) {
  Files files{args.out, fs::path(args.out).replace_extension(".html"),
              fs::path(args.out).replace_extension(".checkpoint")};
  const fs::path dir = args.out.has_parent_path() ? args.out.parent_path() : fs::path(".");
  if (!fs::exists(dir)) throw Error(args.out.string() + ": no such folder: " + dir.string());
  check_output_dir(dir);
  for (const fs::path& file : {files.weights, files.page, files.checkpoint})
    if (fs::is_directory(file)) throw Error(file.string() + ": is a folder; expected a file");
  const bool begun = fs::exists(files.checkpoint);
  if (begun && !args.resume)
    throw Error(files.checkpoint.string() +
                ": a training run was interrupted; continue it with --resume, or delete this file "
                "to start over");
  if (!begun && args.resume)
    throw Error(files.checkpoint.string() +
                ": no such file; --resume needs the checkpoint from an interrupted run");
  return files;
}

lab::TrainState first_state(const TrainArgs& args) {
  const lab::TrainOptions& options = args.recipe.train;
  lab::TrainState state = lab::begin_training(options);
  if (args.from.empty()) return state;
  planes::NetworkWeights from = planes::read_weights(args.from);
  if (!(from.config == options.network))
    throw Error(fmt::format(
        "{}: contains weights for a different network; expected weights for {} (--network)",
        args.from.string(), options.network.name));
  state.weights.tensors = std::move(from.tensors);
  return state;
}

/// Inputs of a training besides its state.
struct Session {
  const TrainArgs& args;
  Files files;
  lab::TrainingPurpose purpose;
  TrainingData data;

  const lab::TrainOptions& options() const { return args.recipe.train; }
  int threads() const { return args.input.pipeline.threads; }
};

void write_page(const Session& session, const lab::TrainState& state) {
  const lab::TrainOptions& options = session.options();
  lab::TrainingSummary summary;
  summary.title = "Training of " + session.files.weights.filename().string();
  summary.facts = {
      {"Command", session.args.command},
      {"Recipe", session.args.recipe.name},
      {"Network", fmt::format("{}, {} parameters", options.network.name,
                              planes::parameter_count(options.network))},
      {"Steps", fmt::format("{} of {}", state.step, options.steps)},
      {"Seed", fmt::format("{}", options.seed)},
      {"Clouds", fmt::format("{} synthetic, {} of recordings", session.data.synthetic.size(),
                             session.data.recordings.size())}};
  for (const lab::ValidationSet& set : session.data.validation)
    summary.validation_sets.push_back(set.name);
  summary.epochs = state.epochs;
  write_file_text(session.files.page, lab::training_page(summary));
}

void save(const Session& session, const lab::TrainState& state) {
  lab::write_checkpoint(session.files.checkpoint, state, session.options(), session.purpose);
  write_page(session, state);
}

std::vector<planes::LabelAccuracy> scores(const TrainingData& data,
                                          const planes::NetworkWeights& weights,
                                          int threads) {
  std::vector<planes::LabelAccuracy> scores;
  for (const lab::ValidationSet& set : data.validation)
    scores.push_back(lab::score_network(weights, set.clouds, threads));
  return scores;
}

/// Explains the numbers on each epoch's line.
void explain_epochs(const Session& session) {
  std::vector<std::string> sets;
  for (const lab::ValidationSet& set : session.data.validation) sets.push_back(set.name);
  fmt::print(stderr, "edge: % of correct labels within 2 cm of a different label, on {}\n",
             fmt::join(sets, ", "));
}

/// Scores the current weights.
void end_epoch(const TrainingData& data, lab::TrainState& state, int threads) {
  const int begun = state.epochs.empty() ? 0 : state.epochs.back().step;
  lab::Epoch epoch;
  epoch.step = state.step;
  epoch.train_loss = state.loss_sum / (state.step - begun);
  epoch.validation = scores(data, state.weights, threads);
  state.loss_sum = 0;
  state.epochs.push_back(std::move(epoch));
}

std::string epoch_line(const lab::Epoch& epoch, int steps) {
  std::string line =
      fmt::format("step {:>6} of {}, loss {:.4f}, edge", epoch.step, steps, epoch.train_loss);
  for (const planes::LabelAccuracy& a : epoch.validation)
    line += fmt::format("  {:.1f}", a.edge_percent());
  return line;
}

/// Runs the remaining steps. Returns early on stop.
void train(const Session& session, lab::TrainState& state, const std::stop_token& stop) {
  const lab::TrainOptions& options = session.options();
  const lab::DrawCloud draw = [&](std::uint64_t number) { return session.data.draw(number); };
  const auto started = std::chrono::steady_clock::now();
  const int first = state.step;
  Progress bar("train", options.steps);
  while (state.step < options.steps && !stop.stop_requested()) {
    lab::train_step(state, options, draw, session.threads());
    if (state.step % options.epoch_steps == 0 || state.step == options.steps) {
      end_epoch(session.data, state, session.threads());
      bar.print(epoch_line(state.epochs.back(), options.steps));
      save(session, state);
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - started;
    const double left = spent.count() / (state.step - first) * (options.steps - state.step);
    bar.show(state.step, fmt::format("steps, {} left", minutes_text(left)));
  }
}

/// Prints the last epoch's accuracy, beside the baseline's if there is one; returns whether the
/// baseline is better.
bool print_accuracy(const Session& session, const lab::TrainState& state) {
  const std::vector<planes::LabelAccuracy>& own = state.epochs.back().validation;
  const fs::path& baseline = session.args.baseline;
  std::vector<planes::LabelAccuracy> others;
  if (!baseline.empty())
    others = scores(session.data, planes::read_weights(baseline), session.threads());
  bool ahead = false;
  fmt::print("{:<18} {:>10} {:>10}{}\n", "correct labels [%]", "near edges", "elsewhere",
             others.empty() ? "" : "   of " + baseline.string());
  for (std::size_t s = 0; s < own.size(); ++s) {
    const double edge = own[s].edge_percent(), inner = own[s].inner_percent();
    std::string line =
        fmt::format("{:<18} {:>10.2f} {:>10.2f}", session.data.validation[s].name, edge, inner);
    if (!others.empty()) {
      const double other_edge = others[s].edge_percent(), other_inner = others[s].inner_percent();
      const bool worse = other_edge - edge > kTolerance || other_inner - inner > kTolerance;
      line +=
          fmt::format("   {:>10.2f} {:>10.2f}{}", other_edge, other_inner, worse ? "  worse" : "");
      ahead = ahead || worse;
    }
    fmt::print("{}\n", line);
  }
  return ahead;
}

void check(const TrainArgs& args) {
  if (args.out.extension() != ".safetensors")
    throw Error("train: -o '" + args.out.string() +
                "' is not a weights file; expected a name that ends in .safetensors");
  expect_gravity(args.input.pipeline, "train");
  if (!args.synthetic && args.input.inputs.empty())
    throw Error("train: --recipe recordings needs labeled recordings");
  if (args.input.label_dir && args.input.inputs.empty())
    throw Error("train: --labels needs the recording that the labels belong to");
}

/// Trains a classifier. On stop, leaves a checkpoint to resume from and throws Cancelled. Returns
/// the exit code: 1 if the baseline is better.
int run_train(const TrainArgs& args, std::stop_token stop) {
  check(args);
  const Files files = checked_files(args);
  if (!args.baseline.empty()) planes::read_weights(args.baseline);  // fails now, not after an hour
  LabeledRecordings recordings = load_labeled_recordings(args.input, args.out, stop);
  const int code = recordings.code;
  const lab::TrainingPurpose purpose = training_purpose(args, recordings);
  lab::TrainState state = args.resume
                              ? lab::read_checkpoint(files.checkpoint, args.recipe.train, purpose)
                              : first_state(args);
  const TrainingDataOptions data{args.synthetic, args.validation_clouds,
                                 args.input.pipeline.threads};
  const Session session{
      args, files, purpose,
      make_training_data(args.recipe, data, std::move(recordings), Bar("training set", stop))};
  if (stop.stop_requested()) throw Cancelled();

  if (!state.epochs.empty() && state.epochs[0].validation.size() != session.data.validation.size())
    throw Error(files.checkpoint.string() +
                ": is damaged: its epochs have different validation sets");

  explain_epochs(session);
  train(session, state, stop);
  const lab::TrainOptions& options = args.recipe.train;
  if (state.step < options.steps) {
    save(session, state);
    fmt::print(
        stderr,
        "stopped at step {} of {}; to continue from {}, run the same command with --resume\n",
        state.step, options.steps, files.checkpoint.string());
    throw Cancelled();
  }
  state.weights.training = training_record(args, session.data, state, purpose);
  planes::write_weights(files.weights, state.weights);
  write_page(session, state);
  std::error_code ignored;
  fs::remove(files.checkpoint, ignored);
  const bool baseline_is_ahead = print_accuracy(session, state);
  fmt::print("{}: {} parameters, trained in {} steps; curves in {}\n", files.weights.string(),
             planes::parameter_count(options.network), state.step, files.page.string());
  return code != 0 ? code : baseline_is_ahead ? 1 : 0;
}

void set_recipe(TrainArgs& args, const std::string& name) {
  const std::vector<std::string>& names = lab::recipe_names();
  args.synthetic = name != "recordings";
  if (args.synthetic && std::ranges::find(names, name) == names.end())
    throw Error(fmt::format("unknown recipe \"{}\"; expected {}, or recordings", name,
                            fmt::join(names, ", ")));
  args.recipe = lab::make_recipe(args.synthetic ? name : kDefaultRecipe);
  args.recipe.name = name;
}

void define(CLI::App& app, Line& line, const char* help, bool needs_recording) {
  CLI::App* command = app.add_subcommand("train", help);
  const auto args = std::make_shared<TrainArgs>();
  lab::TrainOptions& train = args->recipe.train;
  add_inputs(command, args->input,
             "Labeled recordings to train on, of any format that planescope info reads");
  add(command, "-o,--out", args->out, "FILE.safetensors", "Weights to write")->required();
  add_read(
      command, "--recipe", [args](const std::string& name) { set_recipe(*args, name); }, "NAME",
      fmt::format("Training data: {}, or recordings, to use only the given ones (default {})",
                  fmt::join(lab::recipe_names(), ", "), kDefaultRecipe));
  add_read(
      command, "--from", [args](const std::string& file) { begin_with(*args, file); }, "FILE",
      "Weights to start from, for fine-tuning");
  add_read(
      command, "--network",
      [&train](const std::string& name) { train.network = planes::network_config(name); },
      "compact|small|official", "Network architecture (default compact)");
  add(command, "--baseline", args->baseline, "FILE",
      "Weights to compare with at the end; exit code 1 if they are better by 0.3 points");
  add(command, "--steps", train.steps, "N", "Training steps (default: those of the recipe)")
      ->transform(whole(1));
  add(command, "--epoch", train.epoch_steps, "N",
      "Steps between validations and checkpoints (default 2500)")
      ->transform(whole(1));
  add_recipe_limits(command, args->recipe, &args->validation_clouds);
  command->add_flag("--balance-classes", train.balance_classes,
                    "Give h and v equal weight in each cloud");
  command->add_flag("--resume", args->resume,
                    "Resume from the checkpoint of FILE; the result is byte-identical");
  add_clouds(command, args->input.pipeline);
  runs(command, line, args, run_train, [args, needs_recording, &line] {
    args->command = line.text;
    // The command that reproduces the training from scratch.
    if (const auto at = line.text.find(kResume); at != std::string::npos)
      args->command.erase(at, kResume.size());
    if (needs_recording && args->input.inputs.empty())
      throw Error(
          "train needs labeled recordings; to train on synthetic clouds only, use planescope-lab "
          "train");
  });
}

}  // namespace

void begin_with(TrainArgs& args, const fs::path& weights) {
  args.from = weights;
  args.recipe.train.network = planes::read_weights(weights).config;
  args.recipe.train.learning_rate *= kFineTuningRate;
}

planes::NetworkWeights teach(const TrainArgs& args,
                             LabeledRecordings recordings,
                             const TeachingProgress& progress) {
  const lab::TrainOptions& options = args.recipe.train;
  const int threads = args.input.pipeline.threads;
  const lab::TrainingPurpose purpose = training_purpose(args, recordings);
  lab::TrainState state = first_state(args);
  const TrainingData data = make_training_data(
      args.recipe, {args.synthetic, args.validation_clouds, threads}, std::move(recordings),
      [&](int done, int all) { progress("synthetic clouds", done, all); });
  const lab::DrawCloud draw = [&](std::uint64_t number) { return data.draw(number); };
  while (state.step < options.steps) {
    progress("steps", state.step, options.steps);
    lab::train_step(state, options, draw, threads);
  }
  progress("steps", state.step, options.steps);
  end_epoch(data, state, threads);
  state.weights.training = training_record(args, data, state, purpose);
  return state.weights;
}

void limit_clouds(lab::TrainingRecipe& recipe, int most, int* also) {
  lab::TrainingSetOptions& set = recipe.set;
  for (int* count : {&set.stairs, &set.boxes, &set.planes, &set.scans, also})
    if (count) *count = std::min(*count, most);
}

void add_recipe_limits(CLI::App* command, lab::TrainingRecipe& recipe, int* also) {
  const auto limit = [&recipe, also](int most) { limit_clouds(recipe, most, also); };
  command
      ->add_option_function<int>("--count", limit,
                                 "Maximum number of clouds of each kind (default all)")
      ->type_name("N")
      ->transform(whole(1));
  const auto seed = [&recipe](int value) {
    recipe.set.seed = recipe.train.seed = static_cast<std::uint64_t>(value);
  };
  command->add_option_function<int>("--seed", seed, "Random seed of clouds and weights (default 1)")
      ->type_name("N")
      ->transform(whole(0));
}

void define_train(CLI::App& app, Line& line) {
  define(app, line,
         "Train the classifier on labeled recordings and synthetic clouds\n"
         "Writes curves as .html next to FILE, and a .checkpoint until training is done.",
         /*needs_recording=*/true);
}

void define_recipe_train(CLI::App& app, Line& line) {
  define(app, line,
         "Train the classifier on synthetic clouds and labeled recordings\n"
         "Writes curves as .html next to FILE, and a .checkpoint until training is done.",
         /*needs_recording=*/false);
}

}  // namespace planescope::app
