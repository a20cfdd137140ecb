#include "app/cli/typed.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <thread>

#include "app/cli/assets.hpp"
#include "app/cli/labelled_list.hpp"
#include "app/cli/paper_recordings.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::app {
namespace {

// Of the learning rate, where trained weights learn on. 200 steps on five frames of another camera
// resolution beside the synthetic set: new frames of that camera gain 0.7 points near edges and the
// validation sets lose nothing; at the full rate the frames gain nothing and the stairs lose 0.4.
constexpr double kFineTuningRate = 0.25;

int thread_count(const Typed& typed) {
  if (typed.threads.empty())
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int threads = parse_integer(typed.threads, "--threads");
  if (threads < 1 || threads > 1024)
    throw Error(fmt::format("--threads: {} is out of range, expected 1 to 1024", threads));
  return threads;
}

int whole_at_least(const std::string& text, const std::string& name, int least) {
  const int value = parse_integer(text, name);
  if (value < least)
    throw Error(fmt::format("{}: {} is out of range, expected at least {}", name, value, least));
  return value;
}

std::uint64_t seed(const Typed& typed) {
  return static_cast<std::uint64_t>(whole_at_least(typed.seed, "--seed", 0));
}

/// Some of these, all where none is given.
std::set<std::string> chosen_parts(const Typed& typed, const std::vector<std::string>& known) {
  const std::vector<std::string> parts = typed.only.empty() ? known : split(typed.only, ',');
  for (const std::string& part : parts)
    if (std::ranges::find(known, part) == known.end())
      throw Error(fmt::format("--only: '{}' is not a part, expected some of {}", part,
                              fmt::join(known, ", ")));
  return {parts.begin(), parts.end()};
}

void limit(const Typed& typed, std::initializer_list<int*> counts) {
  if (typed.count.empty()) return;
  const int most = whole_at_least(typed.count, "--count", 1);
  for (int* count : counts) *count = std::min(*count, most);
}

/// What measures our own steps has nothing to measure of other methods.
void expect_ours(const planes::PipelineOptions& options, const char* command) {
  if (options.method != planes::Method::ours)
    throw Error(fmt::format("{} measures method ours, found {}", command,
                            planes::to_string(options.method)));
}

/// What is about h and v needs gravity.
void expect_gravity(const planes::PipelineOptions& options, const char* command) {
  if (options.gravity.mode == planes::GravityMode::none)
    throw Error(fmt::format("{} is about h and v, which --gravity none leaves open", command));
}

// WxH in pixels.
void set_size(const std::string& text, int& width, int& height) {
  const std::vector<std::string> sides = split(text, 'x');
  if (sides.size() != 2) throw Error("--size: '" + text + "' is not WxH");
  width = whole_at_least(sides[0], "--size", 1);
  height = whole_at_least(sides[1], "--size", 1);
}

/// $PLANESCOPE_DATA, empty where it is not set.
std::filesystem::path data_folder() {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (!data || !*data) return {};
  if (!std::filesystem::is_directory(data))
    throw Error(fmt::format("PLANESCOPE_DATA: {} is not a folder", data));
  return data;
}

/// Without folders and threads: both leave the results alone.
std::string same_paper_command(const BenchPaperArgs& args, const Typed& typed) {
  std::string text = "planescope bench paper";
  for (const std::string& input : typed.inputs)
    text += fmt::format(" {}", std::filesystem::path(input).lexically_normal().filename().string());
  text += fmt::format(" --seed {} --tuning-seed {}", args.seed, args.tuning_seed);
  if (args.quick) text += " --quick";
  if (!args.sets.empty()) text += fmt::format(" --sets {}", typed.sets);
  for (const auto& [name, value] : {std::pair{"--count", typed.count},
                                    {"--frames", typed.frames},
                                    {"--gravity", typed.gravity},
                                    {"--intrinsics", typed.intrinsics},
                                    {"--depth-unit", typed.depth_unit}})
    if (!value.empty()) text += fmt::format(" {} {}", name, value);
  return text;
}

std::string same_real_command(const Typed& typed) {
  const std::string list = std::filesystem::path(typed.frames_list).filename().string();
  std::string text = "planescope bench real";
  for (const auto& [name, value] : {std::pair{"--frames-list", list},
                                    {"--only", typed.only},
                                    {"--half", typed.half},
                                    {"--seeds", typed.seeds},
                                    {"--count", typed.count}})
    if (!value.empty()) text += fmt::format(" {} {}", name, value);
  return text;
}

}  // namespace

planes::PipelineOptions pipeline_options(const Typed& typed) {
  planes::PipelineOptions options;
  if (!typed.profile.empty()) planes::set_option(options, "profile", typed.profile);
  for (const std::string& assignment : typed.set) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) throw Error("--set: '" + assignment + "' is not NAME=VALUE");
    planes::set_option(options, assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  if (!typed.gravity.empty()) planes::set_option(options, "gravity", typed.gravity);
  if (!typed.voxel.empty()) planes::set_option(options, "voxel_size_m", typed.voxel);
  if (!typed.classifier.empty()) planes::set_option(options, "classifier", typed.classifier);
  if (!typed.method.empty()) planes::set_option(options, "method", typed.method);
  if (!typed.max_range.empty()) {
    planes::set_option(options, "max_range_m", typed.max_range);
    options.cloud.range_for_clouds = true;  // clouds are cropped only where that is asked for
  }
  options.threads = thread_count(typed);
  if (!typed.classifier.empty() && options.gravity.mode == planes::GravityMode::none)
    throw Error("--classifier " + typed.classifier +
                ": with --gravity none no point is labelled h or v, leave one of them out");
  return options;
}

InputArgs input_args(const Typed& typed) {
  InputArgs args;
  args.pipeline = pipeline_options(typed);
  args.inputs.assign(typed.inputs.begin(), typed.inputs.end());
  if (!typed.frames.empty()) args.frames = parse_frame_slice(typed.frames);
  if (!typed.labels.empty()) args.label_dir = typed.labels;
  if (!typed.intrinsics.empty()) {
    const std::vector<std::string> parts = split(typed.intrinsics, ',');
    if (parts.size() != 4)
      throw Error("--intrinsics: '" + typed.intrinsics + "' is not FX,FY,CX,CY");
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < 4; ++i) values[i] = parse_number(parts[i], "--intrinsics");
    if (values[0] <= 0 || values[1] <= 0)
      throw Error("--intrinsics: '" + typed.intrinsics +
                  "' has a focal length that is not above 0");
    args.recording.intrinsics = values;
  }
  if (!typed.depth_unit.empty()) {
    const double unit = parse_number(typed.depth_unit, "--depth-unit");
    if (unit <= 0 || unit > 1)
      throw Error("--depth-unit: " + typed.depth_unit +
                  " is out of range, expected metres per count, above 0 and at most 1");
    args.recording.depth_unit_m = unit;
  }
  args.recording.instance_field = typed.instance_field;
  return args;
}

ViewArgs view_args(const Typed& typed) {
  ViewArgs args;
  args.input = input_args(typed);
  args.open = typed.open;
  args.baseline = typed.baseline;
  if (typed.open.empty() && !typed.baseline.empty())
    throw Error("--baseline: is of a report, give --open REPORT.json");
  const bool options_given = !typed.profile.empty() || !typed.set.empty() ||
                             !typed.gravity.empty() || !typed.max_range.empty() ||
                             !typed.voxel.empty() || !typed.classifier.empty() ||
                             !typed.method.empty();
  if (!typed.open.empty() && options_given)
    throw Error(
        "--open brings the options of the session or report: leave out --profile, --set and such");
  args.script = typed.script;
  args.screenshot = typed.screenshot;
  args.state = typed.state;
  args.offscreen = typed.offscreen;
  args.fresh = typed.fresh;
  args.list_actions = typed.actions;
  if (!typed.size.empty()) set_size(typed.size, args.width, args.height);
  if (args.width < 640 || args.height < 400 || args.width > 8192 || args.height > 8192)
    throw Error("--size: " + typed.size + " is out of range, expected 640x400 to 8192x8192");
  if (!typed.scale.empty()) args.scale = parse_number(typed.scale, "--scale");
  if (!(args.scale >= 0.5 && args.scale <= 4))
    throw Error("--scale: " + typed.scale + " is out of range, expected 0.5 to 4");
  return args;
}

BenchDesktopArgs bench_desktop_args(const Typed& typed) {
  BenchDesktopArgs args;
  args.view = view_args(typed);
  args.view.fresh = true;
  expect_ours(args.view.input.pipeline, "bench desktop");
  if (!typed.steps.empty()) args.steps = whole_at_least(typed.steps, "--steps", 1);
  args.out = typed.out;
  args.json = typed.json;
  return args;
}

std::string required_out(const Typed& typed, const std::string& command) {
  if (typed.out.empty()) throw Error(command + " needs an output folder, -o DIR");
  return typed.out;
}

SynthSampleArgs sample_args(const Typed& typed) {
  SynthSampleArgs args;
  args.out = required_out(typed, "synth sample");
  if (!typed.seed.empty()) args.sample.seed = seed(typed);
  if (!typed.scenes.empty()) args.sample.scenes = split(typed.scenes, ',');
  if (!typed.size.empty()) set_size(typed.size, args.sample.width, args.sample.height);
  args.sample.noise = !typed.exact;
  args.sample.color = !typed.depth_only;
  args.sample.gravity = typed.with_gravity;
  return args;
}

SynthStairsArgs stairs_args(const Typed& typed) {
  SynthStairsArgs args;
  args.out = required_out(typed, "synth stairs");
  if (!typed.count.empty()) args.count = whole_at_least(typed.count, "--count", 1);
  if (!typed.points.empty()) args.stairs.points = whole_at_least(typed.points, "--points", 0);
  if (!typed.seed.empty()) args.stairs.seed = seed(typed);
  if (!typed.noise.empty()) args.stairs.noise_m = parse_number(typed.noise, "--noise");
  if (args.stairs.noise_m < 0) throw Error("--noise: " + typed.noise + " is negative");
  args.stairs.random_yaw = !typed.axis_aligned;
  args.threads = thread_count(typed);
  return args;
}

SynthSetArgs set_args(const Typed& typed) {
  SynthSetArgs args;
  args.set = lab::find_evaluation_set(typed.evaluation_set);
  args.out = required_out(typed, "synth set");
  if (args.set.depth && !(typed.points.empty() && typed.noise.empty()))
    throw Error("--points, --noise: " + args.set.name + " has depth images, expected --errors");
  if (!args.set.depth && !typed.errors.empty())
    throw Error("--errors: " + args.set.name + " has clouds, expected --points or --noise");
  args.count = typed.count.empty() ? args.set.frames : whole_at_least(typed.count, "--count", 1);
  if (!typed.seed.empty()) args.options.seed = seed(typed);
  if (!typed.points.empty()) args.options.points = whole_at_least(typed.points, "--points", 0);
  if (!typed.noise.empty()) args.options.noise_m = parse_number(typed.noise, "--noise");
  if (args.options.noise_m < 0) throw Error("--noise: " + typed.noise + " is negative");
  if (!typed.errors.empty()) args.options.errors = lab::parse_depth_errors(typed.errors);
  args.threads = thread_count(typed);
  return args;
}

SynthTrainingArgs training_args(const Typed& typed) {
  SynthTrainingArgs args;
  args.out = required_out(typed, "synth training");
  args.recipe = lab::make_recipe(typed.recipe);
  lab::TrainingSetOptions& set = args.recipe.set;
  if (!typed.seed.empty()) args.recipe.train.seed = set.seed = seed(typed);
  limit(typed, {&set.stairs, &set.boxes, &set.planes, &set.scans});
  args.augmented = typed.augmented;
  args.threads = thread_count(typed);
  return args;
}

TrainArgs train_args(const Typed& typed) {
  TrainArgs args;
  args.out = typed.out;
  if (typed.out.empty()) throw Error("train needs an output file, -o FILE.safetensors");
  if (args.out.extension() != ".safetensors")
    throw Error("train: -o '" + typed.out + "' is not the name of a .safetensors file");
  args.input = input_args(typed);
  expect_gravity(args.input.pipeline, "train");
  args.synthetic = typed.recipe != "recordings";
  const std::vector<std::string>& names = lab::recipe_names();
  if (args.synthetic && std::find(names.begin(), names.end(), typed.recipe) == names.end())
    throw Error(fmt::format("recipe \"{}\" is not known, expected {} or recordings", typed.recipe,
                            fmt::join(names, ", ")));
  args.recipe = lab::make_recipe(args.synthetic ? typed.recipe : "planescope");
  args.recipe.name = typed.recipe;
  if (!args.synthetic && args.input.inputs.empty())
    throw Error("train: --recipe recordings needs labelled recordings to learn from");
  if (args.input.label_dir && args.input.inputs.empty())
    throw Error("train: --labels needs the recording that the labels are of");
  lab::TrainOptions& train = args.recipe.train;
  lab::TrainingSetOptions& set = args.recipe.set;
  if (!typed.seed.empty()) set.seed = train.seed = seed(typed);
  limit(typed, {&set.stairs, &set.boxes, &set.planes, &set.scans, &args.validation_clouds});
  if (!typed.steps.empty()) train.steps = whole_at_least(typed.steps, "--steps", 1);
  if (!typed.epoch.empty()) train.epoch_steps = whole_at_least(typed.epoch, "--epoch", 1);
  if (!typed.from.empty()) {
    args.from = typed.from;
    train.network = planes::read_weights(args.from).config;
    train.learning_rate *= kFineTuningRate;
  }
  if (!typed.network.empty()) train.network = planes::network_config(typed.network);
  args.baseline = typed.baseline;
  train.balance_classes = typed.balance_classes;
  args.resume = typed.resume;
  return args;
}

BenchClassifierArgs bench_classifier_args(const Typed& typed) {
  BenchClassifierArgs args;
  args.input = input_args(typed);
  expect_ours(args.input.pipeline, "bench classifier");
  expect_gravity(args.input.pipeline, "bench classifier");
  args.out = typed.out;
  args.json = typed.json;
  if (!typed.weights.empty()) args.weights = typed.weights;
  if (!typed.seed.empty()) args.seed = seed(typed);
  if (!typed.count.empty()) args.count = whole_at_least(typed.count, "--count", 1);
  if (!typed.rounds.empty()) args.rounds = whole_at_least(typed.rounds, "--rounds", 1);
  args.parts = {"accuracy", "gravity", "chain", "speed"};
  if (!typed.inputs.empty()) args.parts.insert("frames");
  if (!typed.only.empty()) args.parts = chosen_parts(typed, bench_classifier_parts());
  return args;
}

BenchPaperArgs bench_paper_args(const Typed& typed) {
  BenchPaperArgs args;
  args.out = typed.out;
  args.from = typed.from;
  args.doc = typed.doc;
  if (typed.doc.empty() && typed.out.empty())
    throw Error("bench paper needs an output folder, -o DIR");
  if (!typed.doc.empty() && typed.from.empty())
    throw Error("--doc needs the results that it is written from, --from DIR");
  if (typed.weights.size() > 1) throw Error("--weights: bench paper measures one network");
  if (!typed.weights.empty()) args.weights = typed.weights[0];
  if (!typed.seed.empty()) args.seed = seed(typed);
  if (!typed.tuning_seed.empty())
    args.tuning_seed =
        static_cast<std::uint64_t>(whole_at_least(typed.tuning_seed, "--tuning-seed", 1));
  if (args.seed == 0) throw Error("--seed: 0 is out of range, expected at least 1");
  if (!typed.count.empty()) args.count = whole_at_least(typed.count, "--count", 1);
  if (!typed.sets.empty()) args.sets = split(typed.sets, ',');
  for (const std::string& set : args.sets)
    if (set != lab::kRealLabelled) lab::find_evaluation_set(set);
  args.quick = typed.quick;
  args.resume = typed.resume;
  args.json = typed.json;
  args.parts = chosen_parts(typed, bench_paper_parts());
  args.threads = thread_count(typed);
  args.data = data_folder();
  for (const std::string& input : typed.inputs) {
    Typed one = typed;
    one.inputs = {input};
    one.labels.clear();
    args.recordings.push_back(
        {std::filesystem::absolute(input + "/").parent_path().filename().string(),
         input_args(one)});
  }
  if (typed.inputs.empty() && !args.data.empty() && typed.from.empty())
    args.recordings = listed_recordings(
        find_asset("paper_recordings.txt", "the list of bench paper's recordings is"), args.data);
  for (const auto& recording : args.recordings)
    expect_gravity(recording.input.pipeline, "bench paper");
  args.same_command = same_paper_command(args, typed);
  return args;
}

BenchRealArgs bench_real_args(const Typed& typed) {
  BenchRealArgs args;
  args.out = required_out(typed, "bench real");
  args.parts = chosen_parts(typed, bench_real_parts());
  const bool frames = args.parts.contains("frames");
  if (frames && typed.frames_list.empty())
    throw Error("bench real needs a list of labelled frames, --frames-list FILE");
  if (frames && typed.labels.empty())
    throw Error("bench real needs the folder of the frames' labels, --labels DIR");
  if (frames || args.parts.contains("repeat")) {
    args.data = typed.data.empty() ? data_folder() : std::filesystem::path(typed.data);
    if (args.data.empty())
      throw Error("bench real needs the folder of recordings, --data DIR or PLANESCOPE_DATA");
    if (!std::filesystem::is_directory(args.data))
      throw Error("--data: " + args.data.string() + " is not a folder");
  }
  if (frames) {
    std::optional<lab::Half> half;
    if (!typed.half.empty()) half = lab::parse_half(typed.half);
    args.frames = labelled_list(typed.frames_list, half);
    args.labels = typed.labels;
    if (!std::filesystem::is_directory(args.labels))
      throw Error("--labels: " + args.labels.string() + " is not a folder");
  }
  for (const std::string& seed :
       split(typed.seeds.empty() ? "1,2,3,4,5,6,1001,2001" : typed.seeds, ',')) {
    const auto value = static_cast<std::uint64_t>(whole_at_least(seed, "--seeds", 1));
    if (std::ranges::find(args.seeds, value) != args.seeds.end())
      throw Error("--seeds: " + seed + " is there twice");
    args.seeds.push_back(value);
  }
  if (!typed.count.empty()) args.count = whole_at_least(typed.count, "--count", 1);
  args.threads = thread_count(typed);
  args.json = typed.json;
  args.same_command = same_real_command(typed);
  return args;
}

ReportGuardArgs guard_args(const Typed& typed) {
  return {typed.baseline, typed.rules, typed.approve};
}

namespace {

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?[]#~`") == std::string::npos)
    return word;
  std::string inner;
  for (const char c : word) inner += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return fmt::format("'{}'", inner);
}

}  // namespace

std::string command_text(int argc, char** argv) {
  std::string text = "planescope";
  for (int i = 1; i < argc; ++i) text.append(1, ' ').append(shell_word(argv[i]));
  return text;
}

std::string frames_command_text(int argc, char** argv) {
  constexpr std::string_view kWithValue[] = {"-o",         "--out",   "--threads",
                                             "--baseline", "--rules", "--shard"};
  constexpr std::string_view kFlags[] = {"--json", "--approve", "--resume"};
  std::string text = "planescope";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i], name = word.substr(0, word.find('='));
    if (std::ranges::find(kFlags, word) != std::end(kFlags)) continue;
    if (std::ranges::find(kWithValue, name) != std::end(kWithValue)) {
      if (name == word) ++i;
    } else if (!word.starts_with("-o")) {
      text.append(1, ' ').append(shell_word(argv[i]));
    }
  }
  return text;
}

}  // namespace planescope::app
