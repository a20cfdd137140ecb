#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/lab/training/training_recipe.hpp"

namespace planescope::app {

// Every number of a recipe, for the files that record what was made with it.
nlohmann::ordered_json json_of(const lab::TrainingSetOptions& set);
nlohmann::ordered_json json_of(const lab::AugmentOptions& options);

}  // namespace planescope::app
