#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/experiments/outline_results.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::app {
namespace {

struct BenchOutlinesArgs {
  std::vector<std::uint64_t> seeds = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14};
  int count = 0;  // frames of a set at most; 0: all
  planes::PipelineOptions pipeline;
  std::filesystem::path out;  // -o
  bool json = false;
  std::string same_command;
};

/// Outlines, certainty and places for a foot on the depth sets, with the errors of the D435. Writes
/// outlines.json and outlines.md, prints the tables, and returns 0; throws Cancelled on stop.
int run_bench_outlines(const BenchOutlinesArgs& args, std::stop_token stop) {
  check_output_dir(args.out);
  planes::PipelineOptions options = args.pipeline;
  options.threads = 1;  // frames side by side
  const planes::ChosenClassifier chosen = choose_classifier(options);
  lab::OutlineResults results;
  results.command = args.same_command;
  results.build = report::build_info();
  results.weights = *chosen.weights;
  results.foot_radius_m = options.foot.radius_m;
  lab::PaperPlan plan;
  plan.count = args.count;
  for (const std::uint64_t seed : args.seeds)
    for (const std::string& set : lab::depth_sets()) {
      lab::OutlineResults::OfSet& of_set = results.sets.emplace_back();
      of_set.set = set;
      of_set.seed = seed;
      of_set.frames.resize(static_cast<std::size_t>(lab::planned_frames(plan, set)));
    }
  // One bar for all: each frame by its set and its place there.
  std::vector<std::pair<lab::OutlineResults::OfSet*, int>> frames;
  for (lab::OutlineResults::OfSet& of_set : results.sets)
    for (int i = 0; i < static_cast<int>(of_set.frames.size()); ++i)
      frames.emplace_back(&of_set, i);
  const auto measure = [&](int i) {
    const auto& [of_set, index] = frames[static_cast<std::size_t>(i)];
    lab::EvaluationOptions of_frame;
    of_frame.seed = of_set->seed;
    of_frame.errors = lab::DepthErrors::d435;
    of_set->frames[static_cast<std::size_t>(index)] = lab::score_outlines(
        lab::make_evaluation_frame(lab::find_evaluation_set(of_set->set), index, of_frame), options,
        chosen.classifier.get());
  };
  work_through(static_cast<int>(frames.size()), args.pipeline.threads, measure,
               Bar("outlines", stop));
  make_output_dir(args.out);
  const std::string json = lab::outline_json(results);
  write_file_text(args.out / "outlines.json", json);
  write_file_text(args.out / "outlines.md", lab::outline_markdown(results));
  fmt::print("{}", args.json ? json : lab::joined(lab::outline_tables(results), lab::to_text));
  return 0;
}

}  // namespace

void define_bench_outlines(CLI::App* bench, Line& line) {
  CLI::App* outlines = bench->add_subcommand(
      "outlines",
      "Outlines, certainty and places for a foot against the truth of synthetic depth frames with\n"
      "the errors of the D435. Writes outlines.json and outlines.md.");
  const auto args = std::make_shared<BenchOutlinesArgs>();
  args->pipeline.foot.radius_m = 0.08;
  args->pipeline.threads = all_cores();
  add_out(outlines, args->out)->required();
  add_json(outlines, args->json);
  add(outlines, "--seeds", args->seeds, "N,...", "Of the depth sets, default 1 to 14")
      ->transform(whole(1));
  add(outlines, "--count", args->count, "N", "At most so many frames of each set; default all")
      ->transform(whole(1));
  add_of_method(outlines, args->pipeline, "--foot", "RADIUS|LENGTHxWIDTH",
                "As `planescope segment` takes it; default 0.08");
  add_method(outlines, args->pipeline);
  runs(outlines, line, args, run_bench_outlines, [args, outlines] {
    args->same_command =
        "planescope-lab bench outlines" +
        typed_text(*outlines, {"--seeds", "--count", "--foot", "--max-range", "--set"});
  });
}

}  // namespace planescope::app
