#include "app/commands/recipe_json.hpp"

#include <nlohmann/json.hpp>

namespace planescope::app {

using Json = nlohmann::ordered_json;

Json json_of(const lab::TrainingSetOptions& set) {
  Json json = {{"stairs", set.stairs},
               {"boxes", set.boxes},
               {"planes", set.planes},
               {"boxes_on_floor", set.boxes_on_floor},
               {"scans", set.scans},
               {"points", set.points},
               {"voxel_size_m", set.voxel_size_m}};
  // Left out where off: the record of weights from before it stays what it was.
  if (set.real_errors) json["real_errors"] = true;
  return json;
}

Json json_of(const lab::AugmentOptions& options) {
  return {{"uniform_noise_m", options.uniform_noise_m},
          {"gaussian_noise_m", options.gaussian_noise_m},
          {"clusters", options.clusters},
          {"cluster_radius_m", options.cluster_radius_m},
          {"tilt_deg", options.tilt_deg},
          {"points", options.points},
          {"thinning", options.thinning},
          {"yaw_deg", options.yaw_deg}};
}

}  // namespace planescope::app
