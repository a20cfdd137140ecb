#pragma once

#include <filesystem>
#include <stop_token>
#include <string>

#include "app/commands/inputs.hpp"
#include "core/lab/training/training_recipe.hpp"

namespace planescope::app {

struct TrainArgs {
  std::filesystem::path out;       // -o FILE.safetensors; the page and the checkpoint lie beside it
  InputArgs input;                 // labelled recordings to learn from as well; none: no recordings
  lab::TrainingRecipe recipe;      // with seed, steps, clouds and network as asked for
  bool synthetic = true;           // false: the recordings alone
  int validation_clouds = 12;      // of each kind
  std::filesystem::path from;      // weights to begin with; empty: random ones
  std::filesystem::path baseline;  // weights to compare with; empty: none
  bool resume = false;             // go on from the checkpoint
  std::string command;             // as it was typed
};

/// Trains a classifier. Stopped, it leaves a checkpoint to resume from and throws Cancelled.
/// Returns the exit code: 1 where the baseline is better.
int run_train(const TrainArgs& args, std::stop_token stop);

}  // namespace planescope::app
