#pragma once

// What planescope train, the trainings of planescope-lab and those of the window share.

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

/// The name of the validation set of frames of the recordings.
inline constexpr const char* kRecordingsSet = "recordings";

/// Every fifth labelled frame is kept for validation.
inline bool is_kept_for_validation(std::size_t labelled_frame) { return labelled_frame % 5 == 4; }

/// Frames of the inputs that have truth.
struct LabelledRecordings {
  std::vector<planes::LabelledCloud> train, validation;
  std::vector<std::string> frames;  // Recording::frame_hash() of all of them, in their order
  std::string sha256;               // of all their points and labels; empty without recordings
  int code = 0;                     // 2: damaged frames were skipped
};

/// What of a frame is learnt from.
struct LabelledFrame {
  planes::LabelledCloud cloud;  // its voxels; empty where it has no truth or none has a label
  std::string sha256;           // Recording::frame_hash()
};
/// Throws Error where gravity is not known.
LabelledFrame make_labelled_frame(const Frame& frame,
                                  const planes::SourceTruth& truth,
                                  std::string sha256,
                                  const planes::PipelineOptions& options);
/// Frames without truth are left out.
LabelledRecordings labelled_recordings(std::vector<LabelledFrame> frames);

/// None where no input is given. Throws Error where the inputs have no label, Cancelled on stop.
LabelledRecordings load_labelled_recordings(const InputArgs& args,
                                            const std::filesystem::path& out,
                                            const std::stop_token& stop);

/// What a training learns from and what it is scored on.
struct TrainingData {
  lab::TrainingRecipe recipe;
  std::vector<planes::LabelledCloud> synthetic, recordings;  // one of them may be empty
  std::vector<lab::ValidationSet> validation;  // the recordings' own, where there is one, last
  std::vector<std::string> frames;             // LabelledRecordings::frames

  /// Cloud `number` of the training, varied as the recipe has it.
  planes::LabelledCloud draw(std::uint64_t number) const;
};

struct TrainingDataOptions {
  bool synthetic = true;
  int validation_clouds = 12;  // of each kind
  int threads = 1;
};

/// Makes the synthetic clouds and puts the recordings beside them. `progress(done, all)` may throw
/// to stop.
TrainingData make_training_data(const lab::TrainingRecipe& recipe,
                                const TrainingDataOptions& options,
                                LabelledRecordings recordings,
                                const std::function<void(int, int)>& progress);

constexpr const char* kDefaultRecipe = "planescope";

struct TrainArgs {
  std::filesystem::path out;  // -o FILE.safetensors; the page and the checkpoint lie beside it
  InputArgs input;            // labelled recordings to learn from as well; none: no recordings
  /// With seed, steps, clouds and network as asked for.
  lab::TrainingRecipe recipe = lab::make_recipe(kDefaultRecipe);
  bool synthetic = true;           // false: the recordings alone
  int validation_clouds = 12;      // of each kind
  std::filesystem::path from;      // weights to begin with; empty: random ones
  std::filesystem::path baseline;  // weights to compare with; empty: none
  bool resume = false;             // go on from the checkpoint
  std::string command;             // as it was typed
};

/// Weights to begin with, of whatever network they are: taught more, they are taught gently.
void begin_with(TrainArgs& args, const std::filesystem::path& weights);

/// `stage`: "synthetic clouds", "steps". May throw to stop.
using TeachingProgress = std::function<void(const char* stage, int done, int all)>;

/// Trains as `planescope train` does, in memory from beginning to end: `out` is not looked at. The
/// weights come with their record.
planes::NetworkWeights teach(const TrainArgs& args,
                             LabelledRecordings recordings,
                             const TeachingProgress& progress);

/// At most so many clouds of each kind. `also`: a number of clouds that is limited as well.
void limit_clouds(lab::TrainingRecipe& recipe, int most, int* also = nullptr);

/// --count and --seed of a recipe; `also` as of limit_clouds().
void add_recipe_limits(CLI::App* command, lab::TrainingRecipe& recipe, int* also = nullptr);

/// planescope-lab train: as planescope train, also without any recording.
void define_recipe_train(CLI::App& app, Line& line);

nlohmann::ordered_json json_of(const lab::TrainingSetOptions& set);
nlohmann::ordered_json json_of(const lab::AugmentOptions& options);

/// How weights were trained, as a JSON object for their file: nothing in it depends on where, when
/// or with how many threads that was.
std::string training_record(const TrainArgs& args,
                            const TrainingData& data,
                            const lab::TrainState& state,
                            const lab::TrainingPurpose& purpose);

/// What a checkpoint must agree with beyond the trainer's own options.
lab::TrainingPurpose training_purpose(const TrainArgs& args, const LabelledRecordings& recordings);

}  // namespace planescope::app
