#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "core/lab/training/training_recipe.hpp"

namespace planescope::app {

/// Frames of the inputs that have truth: every fifth of them is kept for validation.
struct LabelledRecordings {
  std::vector<planes::LabelledCloud> train, validation;
  std::string sha256;  // of all their points and labels; empty without recordings
};

/// None where no input is given. Throws Error where the inputs have no label, Cancelled on stop.
LabelledRecordings load_labelled_recordings(const InputArgs& args, const std::stop_token& stop);

/// What a training learns from and what it is scored on.
struct TrainingData {
  lab::TrainingRecipe recipe;
  std::vector<planes::LabelledCloud> synthetic, recordings;  // one of them may be empty
  std::vector<lab::ValidationSet> validation;

  /// Cloud `number` of the training, varied as the recipe has it.
  planes::LabelledCloud draw(std::uint64_t number) const;
};

struct TrainingDataOptions {
  bool synthetic = true;
  int validation_clouds = 12;  // of each kind
  int threads = 1;
};

/// Makes the synthetic clouds and puts the recordings beside them. Throws Cancelled on stop.
TrainingData make_training_data(const lab::TrainingRecipe& recipe,
                                const TrainingDataOptions& options,
                                LabelledRecordings recordings,
                                const std::stop_token& stop);

}  // namespace planescope::app
