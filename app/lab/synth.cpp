// planescope-lab synth: generates sets of frames for evaluation and for training the classifier.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/train.hpp"
#include "app/lab/lab.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/lab/bench/stairs_bench.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;

struct SynthSetArgs {
  std::filesystem::path out;  // -o
  lab::EvaluationSet set;
  int count = 0;  // 0: the size used by the benchmarks
  lab::EvaluationOptions options;
  // Empty unless typed: they apply either to clouds or to depth images.
  std::optional<int> points;
  std::optional<double> noise_m;
  std::optional<lab::DepthErrors> errors;
  int threads = all_cores();  // for clouds
};

/// Writes DIR/NAME.ply for each cloud.
int write_set_clouds(const SynthSetArgs& args, const std::string& task, std::stop_token stop) {
  make_output_dir(args.out);
  std::atomic<int> done = 0;
  {
    Progress progress(task, args.count);
    const auto make = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i) {
        const lab::EvaluationFrame made =
            lab::make_evaluation_frame(args.set, static_cast<int>(i), args.options);
        io::write_ply(args.out / (made.name + ".ply"), *made.frame.cloud);
        ++done;
        if (begin == 0) progress.show(done, "");  // one thread reports for all
      }
    };
    parallel_for(static_cast<std::size_t>(args.count), args.threads, make, 1);
  }
  fmt::print("{}: {} clouds of {}\n", args.out.string(), done.load(), args.set.name);
  if (stop.stop_requested()) throw Cancelled();
  return 0;
}

int write_set_depth(const SynthSetArgs& args, const std::string& task, std::stop_token stop) {
  const lab::SampleFolder folder{
      fmt::format("planescope-lab {} --errors {}", task, lab::to_string(args.options.errors)),
      args.options.seed, static_cast<std::size_t>(args.count), /*color=*/false, /*gravity=*/true};
  constexpr double kNearM = planes::CloudOptions{}.max_range_m;
  std::vector<lab::FrameStairs> stairs;
  {
    Progress progress(task, args.count);
    lab::write_sample_folder(args.out, folder, [&](std::size_t i) {
      if (stop.stop_requested()) throw Cancelled();
      progress.show(static_cast<int>(i), "");
      lab::EvaluationFrame made =
          lab::make_evaluation_frame(args.set, static_cast<int>(i), args.options);
      if (made.stairs) stairs.push_back({made.name, *made.stairs, lab::seen_steps(made, kNearM)});
      return lab::SampleFrame{std::move(made.frame), std::move(*made.labels), std::move(made.name)};
    });
  }
  std::string truth = labels::default_label_dir(args.out).string();
  if (!stairs.empty()) {
    const std::filesystem::path stairs_file =
        labels::default_label_dir(args.out).replace_extension(".stairs.json");
    write_file_text(stairs_file, lab::true_stairs_json(args.set.name, stairs, kNearM));
    truth += " and " + stairs_file.string();
  }
  fmt::print("{}: {} frames of {}, ground truth in {}\n", args.out.string(), args.count,
             args.set.name, truth);
  return 0;
}

/// Applies the typed options; throws Error if one does not fit the set.
void set_options(SynthSetArgs& args) {
  if (args.set.depth && (args.points || args.noise_m))
    throw Error("--points, --noise: " + args.set.name + " contains depth images; use --errors");
  if (!args.set.depth && args.errors)
    throw Error("--errors: " + args.set.name + " contains point clouds; use --points or --noise");
  if (args.count == 0) args.count = args.set.frames;
  args.options.points = args.points.value_or(args.options.points);
  args.options.noise_m = args.noise_m.value_or(args.options.noise_m);
  args.options.errors = args.errors.value_or(args.options.errors);
}

/// Writes frames of an evaluation set: clouds like synth stairs, depth images like synth sample.
int run_synth_set(const SynthSetArgs& args, std::stop_token stop) {
  check_output_dir(args.out);
  const std::string task = "synth set " + args.set.name;
  return args.set.depth ? write_set_depth(args, task, stop) : write_set_clouds(args, task, stop);
}

void add_of_clouds(CLI::App* command, SynthSetArgs& args) {
  add(command, "--count", args.count, "N", "Number of frames (default: as in benchmarks)")
      ->transform(whole(1));
  add(command, "--points", args.points, "N",
      "Points of each cloud (default 8192); 0: dense sampling")
      ->transform(whole(0));
  add(command, "--noise", args.noise_m, "M",
      "Standard deviation of the noise on every coordinate of a cloud, in meters (default 0)")
      ->check(number(0));
  add(command, "--seed", args.options.seed, "N", "Random seed (default 1)")->transform(whole(0));
  add_threads(command, args.threads);
}

void define_stairs(CLI::App* synth, Line& line) {
  CLI::App* command = synth->add_subcommand(
      "stairs", "Write the paper's evaluation set: PLY clouds with label and instance");
  const auto args = std::make_shared<SynthSetArgs>();
  args->set = lab::find_evaluation_set("stairs");
  add_out(command, args->out)->required();
  add_of_clouds(command, *args);
  runs(command, line, args, run_synth_set, [args] { set_options(*args); });
}

void define_set(CLI::App* synth, Line& line) {
  std::string names = "Set to write:";
  for (const lab::EvaluationSet& set : lab::evaluation_sets())
    names += "\n" + set.name + ": " + set.meaning;
  CLI::App* command = synth->add_subcommand(
      "set", "Write a benchmark set: PLY clouds, or depth images with labels in DIR.labels");
  const auto args = std::make_shared<SynthSetArgs>();
  command
      ->add_option_function<std::string>(
          "NAME", [args](const std::string& name) { args->set = lab::find_evaluation_set(name); },
          names)
      ->type_name("")
      ->required();
  add_out(command, args->out)->required();
  add_of_clouds(command, *args);
  add_read(
      command, "--errors",
      [args](const std::string& text) { args->errors = lab::parse_depth_errors(text); },
      "clean|noise|d435",
      "Errors of depth: none (default), independent noise, or a model of the D435");
  runs(command, line, args, run_synth_set, [args] { set_options(*args); });
}

struct SynthTrainingArgs {
  std::filesystem::path out;  // -o
  lab::TrainingRecipe recipe = lab::make_recipe(kDefaultRecipe);
  bool augmented = false;  // clouds as seen by one training step
  int threads = all_cores();
};

Json header_of(const SynthTrainingArgs& args) {
  const lab::TrainingRecipe& recipe = args.recipe;
  Json json = {{"schema", "planescope.training_set/1"},
               {"made_by", "planescope-lab synth training"},
               {"recipe", recipe.name},
               {"seed", recipe.set.seed},
               {"options", json_of(recipe.set)}};
  json["augmented"] = nullptr;
  if (args.augmented)
    json["augmented"] = {{"objects", json_of(recipe.objects)}, {"scans", json_of(recipe.scans)}};
  return json;
}

std::vector<planes::LabeledCloud> make_clouds(const SynthTrainingArgs& args,
                                              const std::stop_token& stop) {
  Progress bar("synth training", args.recipe.set.count());
  const auto show = [&](int done, int) {
    if (stop.stop_requested()) throw Cancelled();
    bar.show(done, "");
  };
  std::vector<planes::LabeledCloud> clouds =
      lab::make_training_set(args.recipe.set, args.threads, show);
  if (!args.augmented) return clouds;
  for (std::size_t i = 0; i < clouds.size(); ++i) clouds[i] = lab::vary(args.recipe, clouds[i], i);
  return clouds;
}

void write_cloud(const std::filesystem::path& path, const planes::LabeledCloud& cloud) {
  PointSet set;
  set.points = cloud.points;
  for (const Label label : cloud.labels) set.label.push_back(static_cast<std::uint8_t>(label));
  io::write_ply(path, set);
}

/// Writes the training set: labeled clouds DIR/stairs_000.ply and so on, then training.json, whose
/// presence marks a complete set. Throws Cancelled on stop.
int run_synth_training(const SynthTrainingArgs& args, std::stop_token stop) {
  check_output_dir(args.out);
  const std::vector<planes::LabeledCloud> clouds = make_clouds(args, stop);
  make_output_dir(args.out);

  Json json = header_of(args);
  json["clouds"] = Json::array();
  std::map<std::string, int> written;  // by kind
  for (const planes::LabeledCloud& cloud : clouds) {
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

void define_training(CLI::App* synth, Line& line) {
  CLI::App* command = synth->add_subcommand(
      "training", "Write the training data of the classifier: PLY clouds and training.json");
  const auto args = std::make_shared<SynthTrainingArgs>();
  add_out(command, args->out)->required();
  add_read(
      command, "--recipe",
      [args](const std::string& name) { args->recipe = lab::make_recipe(name); }, "NAME",
      fmt::format("Recipe: {} (default {}: the paper's shapes, and scans of scenes made of them)",
                  fmt::join(lab::recipe_names(), ", "), kDefaultRecipe));
  add_recipe_limits(command, args->recipe);
  command->add_flag("--augmented", args->augmented,
                    "Add noise, rotations, and holes, as in training");
  add_threads(command, args->threads);
  runs(command, line, args, run_synth_training);
}

}  // namespace

void define_synth_sets(CLI::App& app, Line& line) {
  CLI::App* synth = app.add_subcommand("synth", "Write synthetic sets with ground truth");
  synth->require_subcommand(0, 1);  // `synth set stairs` names a set, not a command
  define_stairs(synth, line);
  define_set(synth, line);
  define_training(synth, line);
}

}  // namespace planescope::app
