#include <fmt/format.h>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/experiments/map_truth.hpp"
#include "core/lab/experiments/measure_map.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

struct BenchMapArgs {
  lab::MapBenchOptions bench;
  std::vector<std::filesystem::path> maps;  // that planescope map wrote; empty: of walks
  std::filesystem::path cuboids;
  std::filesystem::path out;  // -o; empty: nothing is written
  int count = 1;
  bool true_poses = false;
  bool planes = false;  // of each walk, too
};

std::vector<lab::Table> tables_of_truth(const BenchMapArgs& args) {
  const std::vector<lab::Cuboid> cuboids = lab::read_cuboids(args.cuboids);
  std::vector<lab::Table> tables;
  for (const std::filesystem::path& map : args.maps)
    tables.push_back(lab::map_truth_table(lab::measure_map_truth(map, cuboids), map.string()));
  return tables;
}

std::vector<lab::Table> tables_of_walks(const BenchMapArgs& args, std::stop_token stop) {
  const planes::ChosenClassifier chosen = choose_classifier(args.bench.pipeline);
  std::vector<lab::MapScore> scores;
  std::vector<std::string> names;
  for (int i = 0; i < args.count; ++i)
    for (const bool odometry : {false, true}) {
      if (odometry && args.true_poses) continue;
      lab::MapBenchOptions options = args.bench;
      options.sequence.seed += i;
      options.odometry = odometry;
      options.sequence.color = odometry;  // true poses need none of it
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
  return tables;
}

/// Prints tables, and writes them as map.md. Returns the exit code.
int run_bench_map(const BenchMapArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  const std::vector<lab::Table> tables =
      args.maps.empty() ? tables_of_walks(args, stop) : tables_of_truth(args);
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
      "Tracks and the map of a synthetic walk, with true poses and with odometry's; or maps of\n"
      "real recordings against measured cuboids. With -o: map.md.");
  const auto args = std::make_shared<BenchMapArgs>();
  args->bench.pipeline.threads = all_cores();
  map->add_option("MAP", args->maps, "Folders that planescope map wrote; needs --cuboids");
  add(map, "--cuboids", args->cuboids, "FILE",
      "Boxes on the floor z = 0, one per line: x y z, yaw and three half sizes, in meters and "
      "radians, in the world of the maps' poses");
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
    if (args->maps.empty() != args->cuboids.empty())
      throw Error("bench map: MAP and --cuboids go together");
    expect_gravity(args->bench.pipeline, "bench map");
    expect_ours(args->bench.pipeline, "bench map");
  });
}

}  // namespace planescope::app
