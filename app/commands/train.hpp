#pragma once

// What planescope train and the trainings of planescope-lab share.

#include <filesystem>
#include <string>

#include "app/cli/command.hpp"
#include "core/lab/training/training_recipe.hpp"

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

/// --count and --seed of a recipe; `also`, where given, is a number of clouds that --count limits
/// as well.
void add_recipe_limits(CLI::App* command, lab::TrainingRecipe& recipe, int* also = nullptr);

/// planescope-lab train: as planescope train, also without any recording.
void define_recipe_train(CLI::App& app, Line& line);

}  // namespace planescope::app
