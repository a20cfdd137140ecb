#pragma once

// How a classifier is trained, from beginning to end: on what, how that is varied, by which loss.

#include <cstdint>
#include <string>
#include <vector>

#include "core/lab/training/train.hpp"
#include "core/lab/training/training_set.hpp"

namespace planescope::lab {

struct TrainingRecipe {
  std::string name;
  TrainOptions train;
  TrainingSetOptions set;
  AugmentOptions objects;  // how a cloud is varied each time that it is seen
  AugmentOptions scans;
  double scan_share = 0;     // of the clouds seen
  double uniform_share = 1;  // of the objects seen: with uniform noise, the others with Gaussian

  const AugmentOptions& augmentation_of(const planes::LabelledCloud& cloud) const {
    return cloud.kind == "scan" ? scans : objects;
  }
};

/// "planescope", the default: more than half of it scans, mixed noise, a loss that weighs points
/// near edges more. "real-camera": that, with scans that err as real cameras do, also beyond the
/// crop. "paper": the text of Sec. III, objects alone, plain cross-entropy.
const std::vector<std::string>& recipe_names();

/// Throws Error naming the recipes there are.
TrainingRecipe make_recipe(const std::string& name);

/// A cloud of the recipe's set as the step that draws cloud `number` sees it.
planes::LabelledCloud vary(const TrainingRecipe& recipe,
                           const planes::LabelledCloud& cloud,
                           std::uint64_t number);

/// Cloud `number` of a training with this recipe: one of its set, varied.
planes::LabelledCloud draw_cloud(const TrainingRecipe& recipe,
                                 const std::vector<planes::LabelledCloud>& set,
                                 std::uint64_t number);

/// What no recipe trains on.
struct ValidationSet {
  std::string name;
  std::vector<planes::LabelledCloud> clouds;
};
/// Stairs of 8192 points with 0, 0.1, 0.2 and 0.3 cm of noise, `count` of each, and as many scans.
std::vector<ValidationSet> make_validation_sets(std::uint64_t seed, int count, int threads);

}  // namespace planescope::lab
