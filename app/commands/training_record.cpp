#include "app/commands/training_record.hpp"

#include <nlohmann/json.hpp>

#include "core/model/file_bytes.hpp"

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
  // Left out when off, so that records of older weights stay the same.
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

lab::TrainingPurpose training_purpose(const TrainArgs& args, const LabelledRecordings& recordings) {
  const lab::TrainingRecipe& recipe = args.recipe;
  const auto hash_or_none = [](const std::string& hash) { return hash.empty() ? "none" : hash; };
  return {{"recipe", recipe.name},
          {"synthetic clouds", args.synthetic ? json_of(recipe.set).dump() : "none"},
          {"variation of objects", json_of(recipe.objects).dump()},
          {"variation of scans", json_of(recipe.scans).dump()},
          {"share of scans", Json(recipe.scan_share).dump()},
          {"share of uniform noise", Json(recipe.uniform_share).dump()},
          {"clouds to validate with", Json(args.validation_clouds).dump()},
          {"weights to begin with", args.from.empty() ? "none" : sha256_hex_of_file(args.from)},
          {"recordings", hash_or_none(recordings.sha256)}};
}

std::string training_record(const TrainArgs& args,
                            const TrainingData& data,
                            const lab::TrainState& state,
                            const lab::TrainingPurpose& purpose) {
  const lab::TrainOptions& options = args.recipe.train;
  Json record = {{"recipe", args.recipe.name},
                 {"seed", options.seed},
                 {"steps", state.step},
                 {"batch", options.batch},
                 {"learning_rate", options.learning_rate},
                 {"warm_up_steps", options.warm_up_steps},
                 {"edge_weight", options.edge_weight},
                 {"balance_classes", options.balance_classes},
                 {"planescope", PLANESCOPE_VERSION},
                 {"from", purpose.at("weights to begin with")},
                 {"recordings", purpose.at("recordings")},
                 {"recorded_clouds", data.recordings.size()},
                 {"frames", data.frames},
                 {"synthetic_clouds", data.synthetic.size()}};
  if (args.synthetic)
    record["synthetic"] = {{"set", json_of(args.recipe.set)},
                           {"objects", json_of(args.recipe.objects)},
                           {"scan_share", args.recipe.scan_share},
                           {"uniform_share", args.recipe.uniform_share}};
  record["scans"] = json_of(args.recipe.scans);
  record["loss"] = state.epochs.back().train_loss;
  for (std::size_t s = 0; s < data.validation.size(); ++s) {
    const planes::LabelAccuracy& a = state.epochs.back().validation[s];
    record["validation"][data.validation[s].name] = {{"edge", a.edge_percent()},
                                                     {"inner", a.inner_percent()}};
  }
  return record.dump();
}

}  // namespace planescope::app
