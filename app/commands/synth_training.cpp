#include "app/commands/synth_training.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/recipe_json.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;

Json header_of(const SynthTrainingArgs& args) {
  const lab::TrainingRecipe& recipe = args.recipe;
  Json json = {{"schema", "planescope.training_set/1"},
               {"made_by", "planescope synth training"},
               {"recipe", recipe.name},
               {"seed", recipe.set.seed},
               {"options", json_of(recipe.set)}};
  json["augmented"] = nullptr;
  if (args.augmented)
    json["augmented"] = {{"objects", json_of(recipe.objects)}, {"scans", json_of(recipe.scans)}};
  return json;
}

std::vector<planes::LabelledCloud> make_clouds(const SynthTrainingArgs& args,
                                               const std::stop_token& stop) {
  Progress bar("synth training", args.recipe.set.count());
  const auto show = [&](int done, int) {
    if (stop.stop_requested()) throw Cancelled();
    bar.show(done, "");
  };
  std::vector<planes::LabelledCloud> clouds =
      lab::make_training_set(args.recipe.set, args.threads, show);
  if (!args.augmented) return clouds;
  for (std::size_t i = 0; i < clouds.size(); ++i) clouds[i] = lab::vary(args.recipe, clouds[i], i);
  return clouds;
}

void write_cloud(const std::filesystem::path& path, const planes::LabelledCloud& cloud) {
  PointSet set;
  set.points = cloud.points;
  for (const Label label : cloud.labels) set.label.push_back(static_cast<std::uint8_t>(label));
  io::write_ply(path, set);
}

}  // namespace

int run_synth_training(const SynthTrainingArgs& args, std::stop_token stop) {
  check_output_dir(args.out);
  const std::vector<planes::LabelledCloud> clouds = make_clouds(args, stop);
  std::error_code failed;
  std::filesystem::create_directories(args.out, failed);
  if (failed) throw Error("output " + args.out.string() + ": " + failed.message());

  Json json = header_of(args);
  json["clouds"] = Json::array();
  std::map<std::string, int> written;  // by kind
  for (const planes::LabelledCloud& cloud : clouds) {
    if (stop.stop_requested()) throw Cancelled();
    const std::string name = fmt::format("{}_{:03}.ply", cloud.kind, written[cloud.kind]++);
    write_cloud(args.out / name, cloud);
    const auto h = std::count(cloud.labels.begin(), cloud.labels.end(), Label::h);
    json["clouds"].push_back({{"file", name},
                              {"kind", cloud.kind},
                              {"points", cloud.points.size()},
                              {"h", h},
                              {"v", std::ssize(cloud.labels) - h}});
  }
  const std::string text = json.dump(1) + "\n";
  write_file_text(args.out / "training.json", text);
  fmt::print("{}: {} clouds\n", args.out.string(), clouds.size());
  return 0;
}

}  // namespace planescope::app
