#pragma once

#include <string>
#include <vector>

#include "core/synthetic/training_set.hpp"

namespace planescope {

/// What the classifier learns from, and how a cloud is varied each time that it is seen.
struct TrainingRecipe {
  std::string name;
  TrainingSetOptions set;
  AugmentOptions objects;
  AugmentOptions scans;

  const AugmentOptions& augmentation_of(const LabelledCloud& cloud) const {
    return cloud.kind == "scan" ? scans : objects;
  }
};

/// "planescope", the default: objects with noise like that of depth cameras, and scans.
/// "paper": the text of Sec. III, objects alone.
const std::vector<std::string>& recipe_names();

/// Throws Error naming the recipes there are.
TrainingRecipe make_recipe(const std::string& name);

}  // namespace planescope
