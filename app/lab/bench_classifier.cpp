#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/bench/classifier_bench.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kClassifierParts = {"accuracy", "gravity", "chain", "speed",
                                                   "frames"};

struct BenchClassifierArgs {
  InputArgs input;                             // recordings whose frames are timed; the options
  std::vector<std::string> weights = {"gcn"};  // gcn, the shipped ones, or files
  std::set<std::string> parts;                 // of kClassifierParts
  std::uint64_t seed = 960001;                 // of the clouds: no training has it
  int count = 100;                             // clouds of each kind
  int rounds = 20;                             // of the speed part
  std::filesystem::path out;                   // -o; empty: nothing is written
  bool json = false;
  std::string command;  // as it was typed
};

constexpr double kTiltDeg = 5;

struct Contender {
  lab::NamedClassifier named;
  planes::WeightsRecord record;
  planes::NetworkWeights weights;
};

Contender load(const std::string& weights) {
  if (weights == "pca" || weights == "truth")
    throw Error("--weights: '" + weights + "' is not a network, expected gcn or a weights file");
  const fs::path file =
      weights == "gcn" ? find_asset("classifier.safetensors", "the weights of classifier gcn are")
                       : fs::path(weights);
  planes::PipelineOptions options;
  options.classifier = weights;
  planes::ChosenClassifier chosen = planes::make_classifier(options, file);
  return {{weights == "gcn" ? weights : file.stem().string(), std::move(chosen.classifier)},
          *chosen.weights,
          planes::read_weights(file)};
}

/// Those of files with the same name are called as they were typed.
std::vector<Contender> load_all(const std::vector<std::string>& weights) {
  std::vector<Contender> contenders;
  std::multiset<std::string> names;
  for (const std::string& each : weights) {
    contenders.push_back(load(each));
    names.insert(contenders.back().named.name);
  }
  for (std::size_t i = 0; i < contenders.size(); ++i)
    if (names.count(contenders[i].named.name) > 1) contenders[i].named.name = weights[i];
  return contenders;
}

std::vector<lab::FrameRow> time_frames(const BenchClassifierArgs& args,
                                       const std::vector<Contender>& contenders,
                                       const std::stop_token& stop) {
  planes::PipelineOptions options = args.input.pipeline;
  if (options.segment.by_objective())  // it finds planes of depth images without labels
    options.segment = planes::profile_options(planes::Profile::paper);
  std::set<int> thread_counts = {1, options.threads};
  std::vector<lab::FrameRow> rows;
  for (const OpenInput& input : open_inputs(args.input))
    for (const Contender& contender : contenders)
      for (const int threads : thread_counts) {
        options.threads = threads;
        const std::string name = fs::absolute(input.path / "").parent_path().filename().string();
        try {
          rows.push_back(lab::measure_frames(*input.recording, input.frames, options,
                                             *contender.named.classifier, Bar("frames", stop)));
        } catch (const Error& error) {
          throw Error(fmt::format("{}: {}", input.path.string(), error.what()));
        }
        rows.back().recording = name;
        rows.back().classifier = contender.named.name;
      }
  return rows;
}

lab::ClassifierBench measure(const BenchClassifierArgs& args, const std::stop_token& stop) {
  const auto wanted = [&](const char* part) { return args.parts.contains(part); };
  const std::vector<Contender> contenders = load_all(args.weights);
  const int threads = args.input.pipeline.threads;

  lab::ClassifierBench bench;
  bench.command = args.command;
  bench.machine = lab::this_machine();
  bench.accuracy = wanted("accuracy");
  bench.gravity = wanted("gravity");
  bench.labels = {args.seed, args.count, bench.gravity ? kTiltDeg : 0, threads};
  bench.speed_options = {args.seed, args.rounds, threads};

  std::vector<lab::NamedClassifier> classifiers;
  std::vector<lab::BenchNetwork> networks;
  for (const Contender& contender : contenders) {
    bench.networks.emplace_back(contender.named.name, contender.record);
    classifiers.push_back(contender.named);
    networks.push_back({contender.named.name, contender.weights});
  }
  for (const int neighbours : {8, 16})
    classifiers.push_back({fmt::format("PCA, {} neighbours", neighbours),
                           planes::make_pca_classifier({.neighbours = neighbours})});

  // The recordings first: one that cannot be read is reported before anything slow starts.
  if (wanted("frames")) bench.frame_rows = time_frames(args, contenders, stop);
  if (wanted("speed"))
    bench.speed = lab::measure_speed(networks, bench.speed_options, Bar("speed", stop));
  if (bench.accuracy || bench.gravity)
    bench.label_rows = lab::measure_labels(classifiers, bench.labels, Bar("labels", stop));
  if (wanted("chain"))
    bench.chain_rows = lab::measure_chain(classifiers, args.input.pipeline.segment, bench.labels,
                                          Bar("chain", stop));
  return bench;
}

void write_files(const lab::ClassifierBench& bench, const fs::path& dir) {
  make_output_dir(dir);
  if (const auto tables = lab::result_tables(bench); !tables.empty()) {
    write_file_text(dir / "classifier.md", joined(tables, lab::to_markdown));
    write_file_text(dir / "classifier.json", lab::results_json(bench));
  }
  if (const auto tables = lab::timing_tables(bench); !tables.empty()) {
    write_file_text(dir / "classifier.timings.md", joined(tables, lab::to_markdown));
    write_file_text(dir / "classifier.timings.json", lab::timings_json(bench));
  }
}

/// Measures networks: prints tables, and writes classifier.json and .md, and what depends on time
/// to classifier.timings.json and .md. Returns the exit code; throws Cancelled on stop.
int run_bench_classifier(const BenchClassifierArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  const lab::ClassifierBench bench = measure(args, stop);
  if (!args.out.empty()) write_files(bench, args.out);
  if (args.json) {
    auto json = nlohmann::ordered_json::parse(lab::results_json(bench));
    json["timings"] = nlohmann::ordered_json::parse(lab::timings_json(bench));
    fmt::print("{}\n", json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
    return 0;
  }
  std::vector<lab::Table> tables = lab::result_tables(bench);
  for (lab::Table& table : lab::timing_tables(bench)) tables.push_back(std::move(table));
  fmt::print("{}", joined(tables, lab::to_text));
  return 0;
}

void finish(BenchClassifierArgs& args) {
  expect_ours(args.input.pipeline, "bench classifier");
  expect_gravity(args.input.pipeline, "bench classifier");
  if (!args.parts.empty()) return;
  args.parts = {kClassifierParts.begin(), kClassifierParts.end()};
  if (args.input.inputs.empty()) args.parts.erase("frames");
}

}  // namespace

void define_bench_classifier(CLI::App* bench, Line& line) {
  CLI::App* classifier = bench->add_subcommand(
      "classifier",
      "Labels, planes and speed of networks against PCA normals, on synthetic clouds that no\n"
      "training has seen; and how long frames of the given recordings take.");
  const auto args = std::make_shared<BenchClassifierArgs>();
  add_inputs(classifier, args->input, io::recordings_text(true) + " whose frames are timed");
  classifier->remove_option(classifier->get_option("--labels"));
  add_out(classifier, args->out);
  add_json(classifier, args->json);
  classifier
      ->add_option("--weights", args->weights,
                   wrapped("Networks to measure, side by side: gcn, the one that comes with "
                           "planescope (default), or "
                           "files. May be given many times"))
      ->type_name("gcn|FILE")
      ->allow_extra_args(false);
  add_parts(classifier, args->parts, kClassifierParts,
            fmt::format("Of {}; default: all, frames where recordings are given",
                        fmt::join(kClassifierParts, ", ")));
  add(classifier, "--seed", args->seed, "N", "Another seed makes other clouds")
      ->transform(whole(0));
  add(classifier, "--count", args->count, "N", "Clouds of each kind, default 100")
      ->transform(whole(1));
  add(classifier, "--rounds", args->rounds, "N", "How often speed is measured, default 20")
      ->transform(whole(1));
  add_clouds(classifier, args->input.pipeline);
  runs(classifier, line, args, run_bench_classifier, [args, &line] {
    args->command = line.text;
    finish(*args);
  });
}

}  // namespace planescope::app
