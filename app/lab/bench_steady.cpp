// planescope-lab bench steady: stability of planes under irrelevant changes and from frame to
// frame.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/report.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/experiments/steady.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

struct BenchSteadyArgs {
  InputArgs input;
  std::set<std::string> only;
  fs::path poses;  // --poses; "none": compare pixel by pixel; empty: poses of the recording
  int turns = 20;
  fs::path out;  // -o; empty: stdout
  std::set<lab::SteadyPart> parts;
  std::vector<lab::SteadyMethod> methods;
  std::string same_command;
};

std::vector<std::string> part_names() {
  const auto names = names_of(lab::SteadyPart());
  return {names.begin(), names.end()};
}

/// Reads --poses, else the recording's own poses, else poses.tum in its folder.
lab::FramePoses read_poses(const OpenInput& input, const fs::path& typed) {
  if (typed == "none") return {};
  fs::path file = typed;
  if (file.empty()) {
    lab::FramePoses own = lab::own_poses(*input.recording);
    file = input.path / "poses.tum";
    if (!own.empty() || !fs::is_regular_file(file)) return own;
  }
  std::vector<int> frames(static_cast<std::size_t>(input.recording->frame_count()));
  std::iota(frames.begin(), frames.end(), 0);
  world::PairedPoses paired =
      world::pair_poses(world::read_trajectory(file), *input.recording, frames);
  if (!paired.notice.empty()) notice("{}", paired.notice);
  return std::move(paired.poses);
}

/// Runs the benchmark. Throws Cancelled on stop.
int run_bench_steady(const BenchSteadyArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  InputArgs depth_only = args.input;
  depth_only.recording.color = false;
  std::vector<OpenInput> inputs = open_inputs(depth_only, args.out);
  const int code = leave_out_damaged(inputs);
  if (inputs.size() > 1 && !args.poses.empty() && args.poses != "none")
    throw Error(fmt::format("--poses: {} recordings; expected one", inputs.size()));
  std::vector<lab::FramePoses> poses;
  for (const OpenInput& input : inputs)
    poses.push_back(args.parts.contains(lab::SteadyPart::next) ? read_poses(input, args.poses)
                                                               : lab::FramePoses());
  planes::PipelineOptions ours = args.methods.front().options;
  const planes::ChosenClassifier chosen = choose_classifier(ours);

  lab::ResultLines lines("steady", args.same_command,
                         chosen.weights.value_or(planes::WeightsRecord{}),
                         {{"same_iou", lab::kSamePlaneIou},
                          {"partner_iou", lab::kSteadyPartnerIou},
                          {"big_px", lab::kBigPlanePixels}});
  const std::vector<std::string> names = recording_names(inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto units = static_cast<int>(inputs[i].frames.size() * args.methods.size());
    const planes::FrameThreads threads = planes::threads_for_frames(args.input.pipeline, units);
    lab::SteadyJob job;
    job.recording = inputs[i].recording.get();
    job.frames = inputs[i].frames;
    job.methods = args.methods;
    for (lab::SteadyMethod& method : job.methods) method.options.threads = threads.pipeline.threads;
    job.classifier = chosen.classifier.get();
    job.parts = args.parts;
    job.poses = std::move(poses[i]);
    job.turns = args.turns;
    job.threads = threads.at_once;
    job.progress = Bar("steady", stop);
    job.stop = stop;
    const lab::SteadyScores scores = lab::measure_steady(job);
    for (const std::string& line : scores.refused)
      notice("skipped: {}, {}", inputs[i].path.string(), line);
    lines.add(
        "recording",
        {{"recording", names[i]}, {"poses", !job.poses.empty()}, {"refused", scores.refused}});
    for (const lab::SteadyRow& row : scores.rows)
      for (const lab::SteadyRow::OfFrame& frame : row.frames)
        for (const lab::SteadyPair& pair : frame.pairs) {
          nlohmann::ordered_json json = {
              {"recording", names[i]},
              {"part", names_of(row.part)[static_cast<std::size_t>(row.part)]},
              {"change", row.change},
              {"method", row.method},
              {"frame", frame.frame}};
          json.update(json_of(pair));
          lines.add("pair", json);
        }
  }
  deliver(lines, args.out, "steady");
  return code;
}

std::vector<std::string> typed_values(const CLI::App& command, const char* name) {
  return command.get_option(name)->results();
}

/// Returns ours with the profiles paper and refined plus every rival in this build, or the methods
/// selected by --profile and --method; --set applies to all of them.
std::vector<lab::SteadyMethod> methods_to_measure(const CLI::App& command,
                                                  const planes::PipelineOptions& typed) {
  const std::vector<std::string> set = typed_values(command, "--set");
  const bool one_method =
      !typed_values(command, "--method").empty() || typed.method != planes::Method::ours;
  std::vector<lab::SteadyMethod> methods;
  if (!one_method || typed.method == planes::Method::ours) {
    std::vector<std::string> profiles = typed_values(command, "--profile");
    for (const std::string& assignment : set)
      if (assignment.starts_with("profile=")) profiles = {assignment.substr(8)};
    if (profiles.empty()) profiles = {"paper", "refined"};
    for (const std::string& profile : profiles) {
      planes::PipelineOptions options = typed;
      planes::set_profile(options, profile);
      for (const std::string& assignment : set) set_pipeline_option(options, "--set", assignment);
      methods.push_back({"ours " + fs::path(profile).filename().string(), options});
    }
  }
  for (const std::string& name : lab::rival_names(/*images=*/true)) {
    lab::SteadyMethod method{name, typed, lab::find_library_rival(name)};
    method.options.method =
        method.rival ? planes::Method::region_growing : planes::parse_method(name);
    if (one_method ? !method.rival && method.options.method == typed.method : true)
      methods.push_back(method);
  }
  return methods;
}

void finish(BenchSteadyArgs& args, const CLI::App& typed) {
  const planes::PipelineOptions& pipeline = args.input.pipeline;
  const bool knows_gravity = pipeline.gravity.mode != planes::GravityMode::none;
  const std::vector<std::string> names = part_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto part = static_cast<lab::SteadyPart>(i);
    if (args.only.empty() ? part != lab::SteadyPart::gravity || knows_gravity
                          : args.only.contains(names[i]))
      args.parts.insert(part);
  }
  if (!knows_gravity && args.parts.contains(lab::SteadyPart::gravity))
    throw Error("--only gravity rotates gravity; it cannot be combined with --gravity none");
  if (pipeline.classifier == "truth")
    throw Error(
        "--classifier truth: not supported by bench steady; it needs labels for every frame");
  args.methods = methods_to_measure(typed, pipeline);
  args.same_command = "planescope-lab bench steady";
  for (const fs::path& path : args.input.inputs)
    args.same_command +=
        " " + (path.has_filename() ? path : path.parent_path()).filename().string();
  args.same_command +=
      typed_text(typed, {"--only", "--turns", "--frames", "--intrinsics", "--depth-unit",
                         "--gravity", "--max-range", "--voxel", "--classifier", "--method"});
  for (const char* name : {"--poses", "--profile"})
    for (const std::string& value : typed_values(typed, name))
      args.same_command += fmt::format(" {} {}", name, fs::path(value).filename().string());
  for (const std::string& assignment : typed_values(typed, "--set"))
    args.same_command += " --set " + assignment;
}

}  // namespace

void define_bench_steady(CLI::App* bench, Line& line) {
  CLI::App* steady = bench->add_subcommand(
      "steady",
      "Measure how stable planes are\n"
      "Counts planes that survive meaningless changes and the step to the next frame, for profiles "
      "paper and refined and every other method. Measures every 8th frame unless --frames is "
      "specified. -o writes steady.jsonl.");
  const auto args = std::make_shared<BenchSteadyArgs>();
  args->input.frames.step = 8;
  add_inputs(steady, args->input, "Recordings of depth images; default: the sample recording");
  add_out(steady, args->out);
  add_parts(steady, args->only, part_names(),
            fmt::format("Changes to measure: {} (default: all)", fmt::join(part_names(), ", ")));
  add(steady, "--poses", args->poses, "FILE|none",
      "Camera poses in a format of planescope map (default: the recording's, or poses.tum in its "
      "folder). none: compare with the next frame pixel by pixel");
  add(steady, "--turns", args->turns, "N", "Rotations of gravity for each frame (default 20)")
      ->transform(whole(1, 1000));
  add_method(steady, args->input.pipeline);
  runs(steady, line, args, run_bench_steady, [args, steady] { finish(*args, *steady); });
}

}  // namespace planescope::app
