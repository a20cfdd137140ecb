#pragma once

// Training options, data and functions shared by planescope train, planescope-lab and the window.

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "app/cli/command.hpp"
#include "core/lab/training/checkpoint.hpp"
#include "core/lab/training/training_set.hpp"

namespace planescope::app {

/// Name of the validation set made of recorded frames.
inline constexpr const char* kRecordingsSet = "recordings";

/// Every fifth labeled frame is held out for validation.
inline bool is_kept_for_validation(std::size_t labeled_frame) { return labeled_frame % 5 == 4; }

/// Frames of the inputs with ground truth.
struct LabeledRecordings {
  std::vector<planes::LabeledCloud> train, validation;
  std::vector<std::string> frames;  // Recording::frame_hash() of each, in order
  std::string sha256;               // hash over all points and labels; empty without recordings
  int code = 0;                     // 2: damaged frames were skipped
};

/// Training data of one frame.
struct LabeledFrame {
  planes::LabeledCloud cloud;  // its voxels; empty without truth or labels
  std::string sha256;          // Recording::frame_hash()
};
/// Throws Error if gravity is unknown.
LabeledFrame make_labeled_frame(const Frame& frame,
                                const planes::SourceTruth& truth,
                                std::string sha256,
                                const planes::PipelineOptions& options);
/// Skips frames without ground truth.
LabeledRecordings labeled_recordings(std::vector<LabeledFrame> frames);

/// Returns nothing if there are no inputs. Throws Error if the inputs have no labels, Cancelled on
/// stop.
LabeledRecordings load_labeled_recordings(const InputArgs& args,
                                          const std::filesystem::path& out,
                                          const std::stop_token& stop);

/// Training and validation data.
struct TrainingData {
  lab::TrainingRecipe recipe;
  std::vector<planes::LabeledCloud> synthetic, recordings;  // one of them may be empty
  std::vector<lab::ValidationSet> validation;  // the recordings' own set, if any, is last
  std::vector<std::string> frames;             // LabeledRecordings::frames

  /// Returns cloud `number` of the training, augmented according to the recipe.
  planes::LabeledCloud draw(std::uint64_t number) const;
};

struct TrainingDataOptions {
  bool synthetic = true;
  int validation_clouds = 12;  // of each kind
  int threads = 1;
};

/// Generates the synthetic clouds and adds the recordings. `progress(done, all)` may throw to stop.
TrainingData make_training_data(const lab::TrainingRecipe& recipe,
                                const TrainingDataOptions& options,
                                LabeledRecordings recordings,
                                const std::function<void(int, int)>& progress);

constexpr const char* kDefaultRecipe = "planescope";

struct TrainArgs {
  std::filesystem::path out;  // -o FILE.safetensors; the page and checkpoint are written beside it
  InputArgs input;            // labeled recordings for training; may be empty
  /// Includes the seed, steps, clouds and network on the command line.
  lab::TrainingRecipe recipe = lab::make_recipe(kDefaultRecipe);
  bool synthetic = true;           // false: train on recordings only
  int validation_clouds = 12;      // of each kind
  std::filesystem::path from;      // initial weights; empty: random
  std::filesystem::path baseline;  // weights to compare with; empty: none
  bool resume = false;             // continue from the checkpoint
  std::string command;             // as typed
};

/// Starts from existing weights of any network, which are fine-tuned at a lower learning rate.
void begin_with(TrainArgs& args, const std::filesystem::path& weights);

/// `stage` is "synthetic clouds" or "steps". May throw to stop.
using TeachingProgress = std::function<void(const char* stage, int done, int all)>;

/// Trains like `planescope train`, but entirely in memory: ignores `out`. Returns the weights with
/// their training record.
planes::NetworkWeights teach(const TrainArgs& args,
                             LabeledRecordings recordings,
                             const TeachingProgress& progress);

/// Limits the clouds of each kind to `most`, and `also` too if set.
void limit_clouds(lab::TrainingRecipe& recipe, int most, int* also = nullptr);

/// Adds --count and --seed for a recipe; see limit_clouds() for `also`.
void add_recipe_limits(CLI::App* command, lab::TrainingRecipe& recipe, int* also = nullptr);

/// planescope-lab train: like planescope train, but recordings are optional.
void define_recipe_train(CLI::App& app, Line& line);

nlohmann::ordered_json json_of(const lab::TrainingSetOptions& set);
nlohmann::ordered_json json_of(const lab::AugmentOptions& options);

/// Returns the training record as a JSON object for the weights file. Independent of folder, time
/// and number of threads.
std::string training_record(const TrainArgs& args,
                            const TrainingData& data,
                            const lab::TrainState& state,
                            const lab::TrainingPurpose& purpose);

/// Properties that a checkpoint must match in addition to the trainer's own options.
lab::TrainingPurpose training_purpose(const TrainArgs& args, const LabeledRecordings& recordings);

}  // namespace planescope::app
