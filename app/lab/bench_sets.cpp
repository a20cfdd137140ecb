// planescope-lab bench outlines, map and stairs: scores results on synthetic scenes with exact
// ground truth, and maps of real recordings against measured cuboids.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/bench/stairs_bench.hpp"
#include "core/lab/experiments/measure_map.hpp"
#include "core/lab/experiments/measure_outlines.hpp"
#include "core/model/error.hpp"

namespace planescope::app {

// ---- Outlines ----

namespace {

struct BenchOutlinesArgs {
  std::vector<std::uint64_t> seeds = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14};
  int count = 0;  // maximum frames per set; 0: all
  planes::PipelineOptions pipeline;
  std::filesystem::path out;  // -o; empty: stdout
  std::string same_command;
};

/// Measures outlines, certainty and footholds on the depth sets with simulated D435 errors. Throws
/// Cancelled on stop.
int run_bench_outlines(const BenchOutlinesArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  planes::PipelineOptions options = args.pipeline;
  options.threads = 1;  // frames run in parallel
  const planes::ChosenClassifier chosen = choose_classifier(options);
  lab::ResultLines lines("outlines", args.same_command, *chosen.weights,
                         {{"foot_radius_m", options.foot.radius_m}});
  struct Measured {
    std::string set;
    std::uint64_t seed = 0;
    int index = 0;
    lab::OutlineFrameScore score;
  };
  std::vector<Measured> frames;
  for (const std::uint64_t seed : args.seeds)
    for (const std::string& set : lab::depth_sets())
      for (int i = 0; i < lab::planned_frames({.count = args.count}, set); ++i)
        frames.push_back({set, seed, i, {}});
  const auto measure = [&](int i) {
    Measured& frame = frames[static_cast<std::size_t>(i)];
    frame.score = lab::score_outlines(
        lab::make_evaluation_frame(lab::find_evaluation_set(frame.set), frame.index,
                                   {.seed = frame.seed, .errors = lab::DepthErrors::d435}),
        options, chosen.classifier.get());
  };
  work_through(static_cast<int>(frames.size()), args.pipeline.threads, measure,
               Bar("outlines", stop));
  for (const Measured& frame : frames) {
    nlohmann::ordered_json json = {
        {"set", frame.set}, {"seed", frame.seed}, {"frame", frame.index}};
    json.update(json_of(frame.score));
    lines.add("frame", json);
  }
  deliver(lines, args.out, "outlines");
  return 0;
}

}  // namespace

void define_bench_outlines(CLI::App* bench, Line& line) {
  CLI::App* outlines = bench->add_subcommand(
      "outlines",
      "Score outlines, certainty, and footholds\n"
      "Measures against the truth of synthetic depth frames with the errors of the D435. -o writes "
      "outlines.jsonl.");
  const auto args = std::make_shared<BenchOutlinesArgs>();
  args->pipeline.foot.radius_m = 0.08;
  args->pipeline.threads = all_cores();
  add_out(outlines, args->out);
  add(outlines, "--seeds", args->seeds, "N,...", "Random seeds of the depth sets (default 1 to 14)")
      ->transform(whole(1));
  add(outlines, "--count", args->count, "N", "Maximum number of frames of each set (default all)")
      ->transform(whole(1));
  add_of_method(outlines, args->pipeline, "--foot", "RADIUS|LENGTHxWIDTH",
                "Size of the foot in meters (default 0.08)");
  add_method(outlines, args->pipeline);
  runs(outlines, line, args, run_bench_outlines, [args, outlines] {
    args->same_command =
        "planescope-lab bench outlines" +
        typed_text(*outlines, {"--seeds", "--count", "--foot", "--max-range", "--set"});
  });
}

// ---- Maps ----

namespace {

struct BenchMapArgs {
  lab::MapBenchOptions bench;
  std::vector<std::filesystem::path> maps;  // written by planescope map; empty: simulated walks
  std::filesystem::path cuboids;
  std::filesystem::path out;  // -o; empty: stdout
  int count = 1;
  bool true_poses = false;
  std::string command;  // as typed
};

void measure_truth(const BenchMapArgs& args, lab::ResultLines& lines) {
  const std::vector<lab::Cuboid> cuboids = lab::read_cuboids(args.cuboids);
  for (const std::filesystem::path& map : args.maps) {
    const lab::MapTruthScore score = lab::measure_map_truth(map, cuboids);
    nlohmann::ordered_json json = {{"map", map.string()},
                                   {"elsewhere", score.elsewhere},
                                   {"near_m", lab::kNearFace_m},
                                   {"near_deg", lab::kNearFace_deg}};
    for (const lab::FaceScore& face : score.faces) json["faces"].push_back(json_of(face));
    lines.add("map", json);
  }
}

void measure_walks(const BenchMapArgs& args, const std::stop_token& stop, lab::ResultLines& lines) {
  const planes::ChosenClassifier chosen = choose_classifier(args.bench.pipeline);
  for (int i = 0; i < args.count; ++i)
    for (const bool odometry : {false, true}) {
      if (odometry && args.true_poses) continue;
      lab::MapBenchOptions options = args.bench;
      options.sequence.seed += i;
      options.odometry = odometry;
      options.sequence.color = odometry;  // not needed with true poses
      nlohmann::ordered_json json = {{"seed", options.sequence.seed},
                                     {"poses", odometry ? "odometry" : "true poses"}};
      json.update(json_of(lab::measure_map(options, *chosen.classifier, Bar("map", stop))));
      lines.add("walk", json);
    }
}

int run_bench_map(const BenchMapArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  lab::ResultLines lines("map", args.command, {}, nlohmann::ordered_json::object());
  args.maps.empty() ? measure_walks(args, stop, lines) : measure_truth(args, lines);
  deliver(lines, args.out, "map");
  return 0;
}

}  // namespace

void define_bench_map(CLI::App* bench, Line& line) {
  CLI::App* map = bench->add_subcommand(
      "map",
      "Score tracks and maps\n"
      "Measures the map of a synthetic walk, with true poses and with odometry, or maps of real "
      "recordings against measured cuboids. -o writes map.jsonl.");
  const auto args = std::make_shared<BenchMapArgs>();
  args->bench.pipeline.threads = all_cores();
  map->add_option("MAP", args->maps, "Output folders of planescope map; require --cuboids")
      ->type_name("");
  add(map, "--cuboids", args->cuboids, "FILE",
      "Boxes on the floor z = 0, one per line: x y z, yaw, and three half sizes, in meters and "
      "radians, in the world frame of the poses");
  add_out(map, args->out);
  add(map, "--seed", args->bench.sequence.seed, "N", "Random seed of the first walk (default 1)")
      ->transform(whole(0));
  add(map, "--count", args->count, "N", "Number of walks (default 1)")->transform(whole(1));
  add(map, "--frames", args->bench.sequence.frames, "N", "Frames of each walk (default 300)")
      ->transform(whole(2, 2000));
  add_size(map, args->bench.sequence.width, args->bench.sequence.height,
           "Image size in pixels (default 640x480)", 16, 16);
  map->add_flag("--true-poses", args->true_poses, "Skip odometry, the slowest part");
  add_method(map, args->bench.pipeline);
  runs(map, line, args, run_bench_map, [args, &line] {
    args->command = line.text;
    if (args->maps.empty() != args->cuboids.empty())
      throw Error("bench map: MAP and --cuboids must be used together");
    expect_gravity(args->bench.pipeline, "bench map");
    expect_ours(args->bench.pipeline, "bench map");
  });
}

// ---- Stairs ----

namespace {

struct BenchStairsArgs {
  lab::StairsBenchOptions bench;
  std::filesystem::path out;  // -o; empty: stdout
  std::string command;        // reproduces the results
};

int run_bench_stairs(const BenchStairsArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  const planes::ChosenClassifier chosen = choose_classifier(args.bench.pipeline);
  lab::ResultLines lines("stairs", args.command, chosen.weights.value_or(planes::WeightsRecord{}),
                         {{"seed", args.bench.seed},
                          {"count", args.bench.count},
                          {"max_range_m", args.bench.pipeline.cloud.max_range_m},
                          {"seen_px", lab::kSeenPixels},
                          {"surely_seen_px", lab::kSurelySeenPixels},
                          {"barely_seen_px", lab::kBarelySeenPixels}});
  for (const lab::StairsOfSet& set :
       lab::measure_stairs(args.bench, *chosen.classifier, Bar("stairs", stop)))
    for (const lab::StairsFrame& frame : set.frames) {
      nlohmann::ordered_json json = {{"set", set.set}};
      json.update(json_of(frame));
      lines.add("frame", json);
    }
  deliver(lines, args.out, "stairs");
  return 0;
}

void finish(BenchStairsArgs& args, const CLI::App& typed) {
  expect_gravity(args.bench.pipeline, "bench stairs");
  expect_ours(args.bench.pipeline, "bench stairs");
  args.command = "planescope-lab bench stairs" +
                 typed_text(typed, {"--seed", "--count", "--max-range", "--set", "--classifier"});
}

}  // namespace

void define_bench_stairs(CLI::App* bench, Line& line) {
  CLI::App* stairs =
      bench->add_subcommand("stairs",
                            "Score steps, rise, and going of synthetic stairs\n"
                            "Stairs are seen from below and from above with the errors of the "
                            "D435; boxes must not become stairs. -o writes stairs.jsonl.");
  const auto args = std::make_shared<BenchStairsArgs>();
  args->bench.pipeline.threads = all_cores();
  add_out(stairs, args->out);
  add(stairs, "--seed", args->bench.seed, "N", "Random seed (default 1)")->transform(whole(0));
  add(stairs, "--count", args->bench.count, "N", "Frames of each set (default 100)")
      ->transform(whole(1));
  add_method(stairs, args->bench.pipeline);
  runs(stairs, line, args, run_bench_stairs, [args, stairs] { finish(*args, *stairs); });
}

}  // namespace planescope::app
