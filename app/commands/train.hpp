#pragma once

// What planescope train, the trainings of planescope-lab and those of the window share.

#include <filesystem>
#include <functional>
#include <string>

#include "app/cli/command.hpp"
#include "app/commands/training_data.hpp"
#include "core/lab/training/training_set.hpp"

namespace planescope::app {

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

}  // namespace planescope::app
