#pragma once

#include <filesystem>
#include <stop_token>

#include "core/lab/training/training_recipe.hpp"

namespace planescope::app {

struct SynthTrainingArgs {
  std::filesystem::path out;  // -o
  lab::TrainingRecipe recipe;
  bool augmented = false;  // as one step of training sees the clouds
  int threads = 1;
};

/// Writes the training set: DIR/stairs_000.ply and so on with labels, and training.json last: a
/// folder without it is not complete. Throws Cancelled on stop.
int run_synth_training(const SynthTrainingArgs& args, std::stop_token stop);

}  // namespace planescope::app
