#include "app/cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <thread>

#include "app/commands/eval.hpp"
#include "app/commands/info.hpp"
#include "app/commands/options.hpp"
#include "app/commands/report.hpp"
#include "app/commands/segment.hpp"
#include "app/commands/synth.hpp"
#include "core/base/error.hpp"
#include "core/base/text.hpp"
#include "core/pipeline/options_table.hpp"

namespace planescope {
namespace {

// What was typed, before it is checked. Empty: not given.
struct Typed {
  std::vector<std::string> inputs;
  std::string frames, profile, gravity, intrinsics, depth_unit, max_range, voxel, classifier;
  std::string method = "ours", labels, threads, out;
  std::vector<std::string> set;
  bool json = false;

  std::string seed, count, points, noise, scenes;
  bool axis_aligned = false;
};

constexpr const char* kInputs = "Recordings";
constexpr const char* kMethod = "Method";

void add_inputs(CLI::App* command, Typed& typed, const std::string& what) {
  command->add_option("INPUT", typed.inputs, what)->type_name("");
  command
      ->add_option("--frames", typed.frames,
                   "Which frames, as Python slices a list: 0:100:10, -5:, or 7")
      ->type_name("A:B:STEP")
      ->group(kInputs);
  command
      ->add_option("--gravity", typed.gravity,
                   "Direction in which things fall, in the sensor's own frame (x right, y down, z "
                   "forward; clouds: the file's axes). auto takes the first that exists: the "
                   "recording's own, its IMU, an estimate from the scene")
      ->type_name("auto|X,Y,Z|imu|estimate")
      ->group(kInputs);
  command
      ->add_option("--intrinsics", typed.intrinsics,
                   "Of the depth image, in pixels; wins over files")
      ->type_name("FX,FY,CX,CY")
      ->group(kInputs);
  command->add_option("--depth-unit", typed.depth_unit, "Metres per depth count; wins over files")
      ->type_name("METRES")
      ->group(kInputs);
  command
      ->add_option("--labels", typed.labels, "Ground truth; otherwise <recording>.labels beside it")
      ->type_name("DIR")
      ->group(kInputs);
}

void add_method(CLI::App* command, Typed& typed) {
  const auto option = [&](const std::string& name, std::string& value, const std::string& type,
                          const std::string& help) {
    command->add_option(name, value, help)->type_name(type)->group(kMethod);
  };
  option("--profile", typed.profile, "paper|paper-closest|refined",
         "Where the options' values come from; default refined");
  command
      ->add_option("--set", typed.set,
                   "Any option by its name, after the profile; `planescope options` lists them")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->group(kMethod);
  option("--max-range", typed.max_range, "M",
         "Crop what is farther: depth z of depth frames (default 1.5), distance from the origin of "
         "clouds (default none)");
  option("--voxel", typed.voxel, "M", "Edge of the voxel grid, default 0.02; 0 = none");
  option("--classifier", typed.classifier, "pca|truth", "What labels points h or v; default pca");
  option("--method", typed.method, "ours", "What finds the planes");
  option("--threads", typed.threads, "N",
         "Default: all cores. The results are the same for any number");
}

void add_json(CLI::App* command, Typed& typed) {
  command->add_flag("--json", typed.json, "Print JSON instead of text");
}

void add_out(CLI::App* command, Typed& typed) {
  command->add_option("-o,--out", typed.out, "Output folder; made where it is missing")
      ->type_name("DIR");
}

int thread_count(const Typed& typed) {
  if (typed.threads.empty())
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int threads = parse_integer(typed.threads, "--threads");
  if (threads < 1 || threads > 1024)
    throw Error(fmt::format("--threads: {} is out of range, expected 1 to 1024", threads));
  return threads;
}

PipelineOptions pipeline_options(const Typed& typed) {
  if (typed.method != "ours")
    throw Error("--method: '" + typed.method + "' does not exist, expected ours");
  PipelineOptions options;
  if (!typed.profile.empty()) set_option(options, "profile", typed.profile);
  for (const std::string& assignment : typed.set) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) throw Error("--set: '" + assignment + "' is not NAME=VALUE");
    set_option(options, assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  if (!typed.gravity.empty()) set_option(options, "gravity", typed.gravity);
  if (!typed.voxel.empty()) set_option(options, "voxel_size_m", typed.voxel);
  if (!typed.classifier.empty()) set_option(options, "classifier", typed.classifier);
  if (!typed.max_range.empty()) {
    set_option(options, "max_range_m", typed.max_range);
    options.cloud.range_for_clouds = true;  // clouds are cropped only where that is asked for
  }
  options.threads = thread_count(typed);
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
  return args;
}

std::string required_out(const Typed& typed, const std::string& command) {
  if (typed.out.empty()) throw Error(command + " needs an output folder, -o DIR");
  return typed.out;
}

SynthStairsArgs stairs_args(const Typed& typed) {
  const auto at_least = [](const std::string& text, const std::string& name, int least) {
    const int value = parse_integer(text, name);
    if (value < least)
      throw Error(fmt::format("{}: {} is out of range, expected at least {}", name, value, least));
    return value;
  };
  SynthStairsArgs args;
  args.out = required_out(typed, "synth stairs");
  if (!typed.count.empty()) args.count = at_least(typed.count, "--count", 1);
  if (!typed.points.empty()) args.stairs.points = at_least(typed.points, "--points", 0);
  if (!typed.seed.empty())
    args.stairs.seed = static_cast<std::uint64_t>(at_least(typed.seed, "--seed", 0));
  if (!typed.noise.empty()) args.stairs.noise_m = parse_number(typed.noise, "--noise");
  if (args.stairs.noise_m < 0) throw Error("--noise: " + typed.noise + " is negative");
  args.stairs.random_yaw = !typed.axis_aligned;
  args.threads = thread_count(typed);
  return args;
}

[[maybe_unused]] std::string command_text(int argc, char** argv) {
  std::string text = "planescope";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain =
        !word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?[]#~`") == std::string::npos;
    text += ' ';
    if (plain) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += '\'';
  }
  return text;
}

// The command that was typed last: `synth stairs` is the app of `stairs`.
const CLI::App* innermost(const CLI::App* app) {
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return app;
}

// One line for what CLI11 did not understand, with the name that was probably meant.
std::string message_of(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = innermost(&app);
  const std::vector<std::string> extras = app.remaining(true);
  if (extras.empty()) {
    std::string text = error.what();
    return text.substr(0, text.find('\n'));
  }
  const std::string& word = extras.front();
  const bool is_option = word.size() > 1 && word[0] == '-';
  std::vector<std::string> names;
  if (is_option) {
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  } else {
    for (const CLI::App* sub : command->get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(sub->get_name());
  }
  const std::string given = word.substr(0, word.find('='));
  const std::string near = nearest_name(given, names);
  std::string text = is_option       ? "unknown option '" + given + "'"
                     : names.empty() ? "unexpected argument '" + given + "'"
                                     : "unknown command '" + given + "'";
  if (!near.empty()) return text + ", did you mean '" + near + "'?";
  const std::string name = command == &app ? "" : " " + command->get_name();
  return text + ", see planescope" + name + " --help";
}

}  // namespace

Job parse_command_line(int argc, char** argv) {
  const auto typed = std::make_shared<Typed>();
  Typed& t = *typed;
  CLI::App app(
      "planescope finds planes in depth recordings and point clouds, after Sun et al. 2023, "
      "\"Multi-Resolution Planar Region Extraction\".\n"
      "A command that is given no recording takes the sample that comes with it.",
      "planescope");
  app.set_version_flag("--version", "planescope " PLANESCOPE_VERSION);
  app.get_formatter()->column_width(34);
  Job job;

  CLI::App* info = app.add_subcommand(
      "info", "What is in a recording: sizes, unit, intrinsics, gravity, time and gaps");
  add_inputs(info, t, "Bags, folders, .raw, .ply or .pcd files");
  add_json(info, t);
  info->add_option("--max-range", t.max_range, "Tell how much of the depth is within this range")
      ->type_name("M")
      ->group(kMethod);
  info->final_callback([&job, typed] {
    job = [args = InfoArgs{input_args(*typed), typed->json}](std::stop_token) {
      return run_info(args);
    };
  });

  CLI::App* segment = app.add_subcommand(
      "segment",
      "Find the planes of each frame: planes.json, planes.png, cloud.ply, timings.json.\n"
      "Planes and cloud.ply are in the world frame: z up, metres.");
  add_inputs(segment, t, "One bag, folder, .raw, .ply or .pcd file");
  add_out(segment, t);
  add_json(segment, t);
  add_method(segment, t);
  segment->final_callback([&job, typed] {
    job = [args = SegmentArgs{input_args(*typed), required_out(*typed, "segment"), typed->json}](
              std::stop_token stop) { return run_segment(args, stop); };
  });

#ifdef PLANESCOPE_WITH_REPORT
  CLI::App* report = app.add_subcommand(
      "report", "Write a report that opens in a browser: index.html, report.json, pictures");
  add_inputs(report, t, "Bags, folders, .raw, .ply or .pcd files");
  add_out(report, t);
  add_json(report, t);
  add_method(report, t);
  report->final_callback([&job, typed, command = command_text(argc, argv)] {
    job = [args = ReportArgs{input_args(*typed), required_out(*typed, "report"), typed->json,
                             command}](std::stop_token stop) { return run_report(args, stop); };
  });

#endif

  CLI::App* eval =
      app.add_subcommand("eval", "Metrics against ground truth: label files, or a cloud's fields");
  add_inputs(eval, t, "Bags, folders, .raw, .ply or .pcd files");
  add_json(eval, t);
  add_method(eval, t);
  eval->final_callback([&job, typed] {
    job = [args = EvalArgs{input_args(*typed), typed->json}](std::stop_token stop) {
      return run_eval(args, stop);
    };
  });

  CLI::App* options = app.add_subcommand(
      "options", "List every option that --set takes, with value, unit and meaning");
  add_json(options, t);
  add_method(options, t);
  options->final_callback([&job, typed] {
    job = [args = OptionsArgs{pipeline_options(*typed), typed->json}](std::stop_token) {
      return run_options(args);
    };
  });

  CLI::App* synth = app.add_subcommand("synth", "Write synthetic recordings with ground truth");
  CLI::App* stairs = synth->add_subcommand(
      "stairs", "The paper's evaluation set: stairs as PLY clouds with label and instance");
  add_out(stairs, t);
  stairs->add_option("--count", t.count, "How many stairs, default 100")->type_name("N");
  stairs->add_option("--points", t.points, "Points of each, default 8192; 0 = dense sampling")
      ->type_name("N");
  stairs->add_option("--noise", t.noise, "Standard deviation of the noise, default 0")
      ->type_name("M");
  stairs->add_option("--seed", t.seed, "Another seed makes another set, default 1")->type_name("N");
  stairs->add_flag("--axis-aligned", t.axis_aligned, "Do not turn the stairs about z");
  stairs->add_option("--threads", t.threads, "Default: all cores")->type_name("N");
  stairs->final_callback([&job, typed] {
    job = [args = stairs_args(*typed)](std::stop_token stop) {
      return run_synth_stairs(args, stop);
    };
  });

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    std::ostringstream text;
    app.exit(success, text, text);
    return [text = text.str()](std::stop_token) {
      fmt::print("{}", text);
      return 0;
    };
  } catch (const CLI::ParseError& error) {
    throw Error(message_of(app, error));
  }
  if (!job) {
    const CLI::App* command = innermost(&app);
    if (command != &app) throw Error(command->get_name() + " needs one of: sample, stairs");
    return [text = app.help()](std::stop_token) {
      fmt::print("{}", text);
      return 0;
    };
  }
  return job;
}

}  // namespace planescope
