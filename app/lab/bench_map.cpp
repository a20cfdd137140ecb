#include <fmt/format.h>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/experiments/measure_map.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

struct BenchMapArgs {
  lab::MapBenchOptions bench;
  std::filesystem::path out;  // -o; empty: nothing is written
  int count = 1;
  bool true_poses = false;
  bool planes = false;  // of each walk, too
};

/// Prints a table, and writes it as map.md. Returns the exit code.
int run_bench_map(const BenchMapArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  const planes::ChosenClassifier chosen = choose_classifier(args.bench.pipeline);
  std::vector<lab::MapScore> scores;
  std::vector<std::string> names;
  for (int i = 0; i < args.count; ++i)
    for (const bool odometry : {false, true}) {
      if (odometry && args.true_poses) continue;
      lab::MapBenchOptions options = args.bench;
      options.sequence.seed += i;
      options.odometry = odometry;
      scores.push_back(lab::measure_map(options, *chosen.classifier, Bar("map", stop)));
      names.push_back(
          fmt::format("seed {}, {}", options.sequence.seed, odometry ? "odometry" : "true poses"));
    }
  std::vector<lab::Table> tables{lab::map_table(scores, names)};
  for (std::size_t i = 0; args.planes && i < scores.size(); ++i)
    for (lab::Table table :
         {lab::map_planes_table(scores[i]), lab::track_changes_table(scores[i])}) {
      table.title += fmt::format(", {}", names[i]);
      tables.push_back(std::move(table));
    }
  if (!args.out.empty()) {
    make_output_dir(args.out);
    write_file_text(args.out / "map.md", lab::joined(tables, lab::to_markdown));
  }
  fmt::print("{}", lab::joined(tables, lab::to_text));
  return 0;
}

}  // namespace

void define_bench_map(CLI::App* bench, Line& line) {
  CLI::App* map = bench->add_subcommand(
      "map",
      "Tracks and the map of a synthetic walk, with true poses and with odometry's. With -o: "
      "map.md.");
  const auto args = std::make_shared<BenchMapArgs>();
  args->bench.pipeline.threads = all_cores();
  add_out(map, args->out);
  add(map, "--seed", args->bench.sequence.seed, "N", "The first walk's, default 1")
      ->transform(whole(0));
  add(map, "--count", args->count, "N", "Walks, default 1")->transform(whole(1));
  add(map, "--frames", args->bench.sequence.frames, "N", "Of each walk, default 300")
      ->transform(whole(2, 2000));
  add_size(map, args->bench.sequence.width, args->bench.sequence.height,
           "Of the pictures in pixels, default 640x480", 16, 16);
  map->add_flag("--planes", args->planes,
                "Also each plane of the maps, and each change of a track");
  map->add_flag("--true-poses", args->true_poses, "Without odometry, which takes longest");
  add_method(map, args->bench.pipeline);
  runs(map, line, args, run_bench_map, [args] {
    expect_gravity(args->bench.pipeline, "bench map");
    expect_ours(args->bench.pipeline, "bench map");
  });
}

}  // namespace planescope::app
