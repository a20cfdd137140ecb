#include "core/synthetic/training_recipe.hpp"

#include "core/base/error.hpp"

namespace planescope {
namespace {

TrainingRecipe planescope_recipe() {
  TrainingRecipe recipe;
  // 1 cm would hide the smallest objects altogether: what they are could not be learnt.
  recipe.objects.uniform_noise_m = 0;
  recipe.objects.gaussian_noise_m = 0.004;
  recipe.objects.tilt_deg = 3;
  recipe.objects.thinning = 0.25;
  recipe.scans = recipe.objects;
  recipe.scans.gaussian_noise_m = 0;  // the camera's own is in them
  recipe.scans.thinning = 0.7;
  return recipe;
}

TrainingRecipe paper_recipe() {
  TrainingRecipe recipe;
  recipe.set.boxes_on_floor = 0;
  recipe.set.scans = 0;
  return recipe;
}

}  // namespace

const std::vector<std::string>& recipe_names() {
  static const std::vector<std::string> names = {"planescope", "paper"};
  return names;
}

TrainingRecipe make_recipe(const std::string& name) {
  TrainingRecipe recipe;
  if (name == "planescope") {
    recipe = planescope_recipe();
  } else if (name == "paper") {
    recipe = paper_recipe();
  } else {
    throw Error("recipe \"" + name + "\" is not known, expected planescope or paper");
  }
  recipe.name = name;
  return recipe;
}

}  // namespace planescope
