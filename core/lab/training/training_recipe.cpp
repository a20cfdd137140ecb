#include "core/lab/training/training_recipe.hpp"

#include <fmt/format.h>

#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scan.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/model/error.hpp"
#include "core/model/parallel.hpp"

namespace planescope::lab {
namespace {

enum RecipeStream : std::uint64_t { kIsScan = 101, kWhich, kVariation, kIsUniform };

TrainingRecipe planescope_recipe() {
  TrainingRecipe recipe;
  // 1 cm would bury the smallest objects in noise: nothing could be learnt from them.
  recipe.objects.uniform_noise_m = 0.004;
  recipe.objects.gaussian_noise_m = 0.004;
  recipe.objects.tilt_deg = 2;
  recipe.objects.thinning = 0.5;
  recipe.scans = recipe.objects;
  // Scans keep what the app will see: the camera's own noise, the grid's density, and the world's x
  // axis where the camera looks.
  recipe.scans.uniform_noise_m = recipe.scans.gaussian_noise_m = 0;
  recipe.scans.thinning = 1;
  recipe.scans.yaw_deg = 15;
  recipe.set.planes = 50;  // a plane of any slope teaches next to nothing about edges
  recipe.set.scans = 1400;
  recipe.scan_share = 0.6;
  recipe.uniform_share = 0.15;
  return recipe;
}

TrainingRecipe real_camera_recipe() {
  TrainingRecipe recipe = planescope_recipe();
  recipe.set.real_errors = true;
  return recipe;
}

TrainingRecipe paper_recipe() {
  TrainingRecipe recipe;
  recipe.set.boxes_on_floor = 0;
  recipe.set.scans = 0;
  recipe.train.edge_weight = 1;
  return recipe;
}

}  // namespace

const std::vector<std::string>& recipe_names() {
  static const std::vector<std::string> names = {"planescope", "real-camera", "paper"};
  return names;
}

TrainingRecipe make_recipe(const std::string& name) {
  TrainingRecipe recipe;
  if (name == "planescope") {
    recipe = planescope_recipe();
  } else if (name == "real-camera") {
    recipe = real_camera_recipe();
  } else if (name == "paper") {
    recipe = paper_recipe();
  } else {
    throw Error(fmt::format("recipe \"{}\" is not known, expected one of {}", name,
                            fmt::join(recipe_names(), ", ")));
  }
  recipe.name = name;
  return recipe;
}

planes::LabelledCloud vary(const TrainingRecipe& recipe,
                           const planes::LabelledCloud& cloud,
                           std::uint64_t number) {
  const std::uint64_t seed = recipe.train.seed;
  AugmentOptions options = recipe.augmentation_of(cloud);
  const bool uniform = random_uniform(seed, kIsUniform, number) < recipe.uniform_share;
  (uniform ? options.gaussian_noise_m : options.uniform_noise_m) = 0;
  return augment(cloud, options, random_bits(seed, kVariation, number));
}

planes::LabelledCloud draw_cloud(const TrainingRecipe& recipe,
                                 const std::vector<planes::LabelledCloud>& set,
                                 std::uint64_t number) {
  const std::uint64_t seed = recipe.train.seed;
  const int all_objects = recipe.set.stairs + recipe.set.boxes + recipe.set.planes;
  const auto objects = static_cast<std::uint64_t>(all_objects);
  const bool scan = random_uniform(seed, kIsScan, number) < recipe.scan_share;
  const std::uint64_t first = scan ? objects : 0, count = scan ? set.size() - objects : objects;
  return vary(recipe, set[first + random_bits(seed, kWhich, number) % count], number);
}

std::vector<ValidationSet> make_validation_sets(std::uint64_t seed, int count, int threads) {
  std::vector<ValidationSet> sets;
  for (const double noise_cm : {0.0, 0.1, 0.2, 0.3}) {
    ValidationSet& set = sets.emplace_back();
    set.name = fmt::format("stairs {} cm", noise_cm);
    set.clouds.resize(static_cast<std::size_t>(count));
    const StairsOptions options{.seed = seed, .noise_m = noise_cm / 100};
    const auto make = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        set.clouds[i] = labelled(make_stairs(static_cast<int>(i), options));
    };
    parallel_for(set.clouds.size(), threads, make, 1);
  }
  sets.push_back({"scans", make_test_scans(seed, count, 0.02, threads)});
  return sets;
}

}  // namespace planescope::lab
