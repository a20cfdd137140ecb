#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/lab/training/training_recipe.hpp"

namespace planescope {

// Every number of a recipe, for the files that record what was made with it.
nlohmann::ordered_json json_of(const TrainingSetOptions& set);
nlohmann::ordered_json json_of(const AugmentOptions& options);

}  // namespace planescope
