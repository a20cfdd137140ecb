#include <fmt/format.h>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/bench/stairs_bench.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

struct BenchStairsArgs {
  lab::StairsBenchOptions bench;
  std::filesystem::path out;  // -o; empty: nothing is written
  bool json = false;
  std::string command;  // measures the same again
};

/// Prints tables, and writes stairs.json and stairs.md. Returns the exit code.
int run_bench_stairs(const BenchStairsArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  const planes::ChosenClassifier chosen = choose_classifier(args.bench.pipeline);
  lab::StairsRun run{
      args.command, args.bench, chosen.weights.value_or(planes::WeightsRecord{}), {}};
  run.sets = lab::measure_stairs(args.bench, *chosen.classifier, Bar("stairs", stop));
  const std::vector<lab::Table> tables = lab::stairs_tables(run.sets);
  const std::string json = lab::stairs_bench_json(run);
  if (!args.out.empty()) {
    make_output_dir(args.out);
    write_file_text(args.out / "stairs.json", json);
    write_file_text(args.out / "stairs.md", joined(tables, lab::to_markdown));
  }
  fmt::print("{}", args.json ? json : joined(tables, lab::to_text));
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
                            "Steps, rise and going of synthetic stairs seen from below and from "
                            "above, by a model of the\n"
                            "D435, and boxes that are none. With -o: stairs.json and stairs.md.");
  const auto args = std::make_shared<BenchStairsArgs>();
  args->bench.pipeline.threads = all_cores();
  add_out(stairs, args->out);
  add_json(stairs, args->json);
  add(stairs, "--seed", args->bench.seed, "N", "Another seed makes other frames, default 1")
      ->transform(whole(0));
  add(stairs, "--count", args->bench.count, "N", "Frames of each set, default 100")
      ->transform(whole(1));
  add_method(stairs, args->bench.pipeline);
  runs(stairs, line, args, run_bench_stairs, [args, stairs] { finish(*args, *stairs); });
}

}  // namespace planescope::app
