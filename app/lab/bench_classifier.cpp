// planescope-lab bench classifier: compares networks with PCA normals.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/lab/lab.hpp"
#include "core/lab/bench/classifier_bench.hpp"
#include "core/model/error.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const std::vector<std::string> kClassifierParts = {"accuracy", "gravity", "chain", "speed",
                                                   "frames"};

struct BenchClassifierArgs {
  InputArgs input;                             // recordings to time, and their options
  std::vector<std::string> weights = {"gcn"};  // gcn (the shipped weights) or files
  std::set<std::string> parts;                 // of kClassifierParts
  std::uint64_t seed = 960001;                 // of the clouds; not used in training
  int count = 100;                             // clouds of each kind
  int rounds = 20;                             // of the speed part
  std::filesystem::path out;                   // -o; empty: stdout
  std::string command;                         // as typed
};

constexpr double kTiltDeg = 5;

struct Contender {
  lab::NamedClassifier named;
  planes::WeightsRecord record;
  planes::NetworkWeights weights;
};

Contender load(const std::string& weights) {
  if (weights == "pca" || weights == "truth")
    throw Error("--weights: '" + weights + "' is not a network; expected gcn or a weights file");
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

/// Loads all networks. Files with the same name are listed by path.
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

/// Returns the exit code.
int time_frames(const BenchClassifierArgs& args,
                const std::vector<Contender>& contenders,
                const std::stop_token& stop,
                lab::ResultLines& lines) {
  planes::PipelineOptions options = args.input.pipeline;
  if (options.segment.by_objective())  // which segments depth images without labels
    options.segment = planes::profile_options(planes::Profile::paper);
  const std::set<int> thread_counts = {1, options.threads};
  std::vector<OpenInput> inputs = open_inputs(args.input, args.out);
  const int code = leave_out_damaged(inputs);
  for (const OpenInput& input : inputs)
    for (const Contender& contender : contenders)
      for (const int threads : thread_counts) {
        options.threads = threads;
        Json json = {{"recording", fs::absolute(input.path / "").parent_path().filename().string()},
                     {"classifier", contender.named.name}};
        try {
          json.update(
              json_of(lab::measure_frames(*input.recording, input.frames, options,
                                          *contender.named.classifier, Bar("frames", stop))));
        } catch (const Error& error) {
          throw Error(fmt::format("{}: {}", input.path.string(), error.what()));
        }
        lines.add("frames", json);
      }
  return code;
}

Json json_of_accuracy(const planes::LabelAccuracy& accuracy) {
  return {{"edge_percent", accuracy.edge_percent()},
          {"inner_percent", accuracy.inner_percent()},
          {"edge_points", accuracy.edge},
          {"inner_points", accuracy.inner}};
}

/// Measures networks: accuracy goes to classifier.jsonl, times to classifier.timings.jsonl. Throws
/// Cancelled on stop.
int run_bench_classifier(const BenchClassifierArgs& args, std::stop_token stop) {
  if (!args.out.empty()) check_output_dir(args.out);
  const auto wanted = [&](const char* part) { return args.parts.contains(part); };
  const std::vector<Contender> contenders = load_all(args.weights);
  const int threads = args.input.pipeline.threads;
  const lab::LabelBenchOptions of_labels{args.seed, args.count, wanted("gravity") ? kTiltDeg : 0,
                                         threads};
  lab::ResultLines results("classifier", args.command, {},
                           {{"seed", args.seed},
                            {"count", args.count},
                            {"accuracy", wanted("accuracy")},
                            {"tilt_deg", of_labels.tilt_deg}});
  lab::ResultLines timings("classifier.timings", args.command, {},
                           {{"machine", lab::machine_json(lab::this_machine())},
                            {"seed", args.seed},
                            {"rounds", args.rounds}});
  std::vector<lab::NamedClassifier> classifiers;
  std::vector<lab::BenchNetwork> networks;
  for (const Contender& contender : contenders) {
    results.add("network", {{"name", contender.named.name},
                            {"file", contender.record.file},
                            {"sha256", contender.record.sha256},
                            {"network", contender.record.network},
                            {"training", Json::parse(contender.record.training)}});
    classifiers.push_back(contender.named);
    networks.push_back({contender.named.name, contender.weights});
  }
  for (const int neighbors : {8, 16})
    classifiers.push_back({fmt::format("PCA, {} neighbours", neighbors),
                           planes::make_pca_classifier({.neighbors = neighbors})});

  // Recordings first, so that an unreadable one is reported before anything slow starts.
  const int code = wanted("frames") ? time_frames(args, contenders, stop, timings) : 0;
  if (wanted("speed")) {
    const lab::SpeedBench bench =
        lab::measure_speed(networks, {args.seed, args.rounds, threads}, Bar("speed", stop));
    for (const lab::SpeedRow& row : bench.speed) timings.add("speed", json_of(row));
    for (const lab::ReferenceRow& row : bench.reference) timings.add("reference", json_of(row));
  }
  if (wanted("accuracy") || wanted("gravity"))
    for (const lab::LabelRow& row :
         lab::measure_labels(classifiers, of_labels, Bar("labels", stop))) {
      Json json = {{"clouds", row.set},
                   {"classifier", row.classifier},
                   {"level", json_of_accuracy(row.level)}};
      if (wanted("gravity")) json["tilted"] = json_of_accuracy(row.tilted);
      results.add("labels", json);
    }
  if (wanted("chain"))
    for (const lab::ChainRow& row : lab::measure_chain(classifiers, args.input.pipeline.segment,
                                                       of_labels, Bar("chain", stop)))
      results.add("chain", lab::with_metrics({{"noise_cm", row.noise_cm}, {"labels", row.labels}},
                                             row.metrics));
  if (wanted("accuracy") || wanted("gravity") || wanted("chain"))
    deliver(results, args.out, "classifier");
  if (wanted("speed") || wanted("frames")) deliver(timings, args.out, "classifier.timings");
  return code;
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
      "Compare networks with PCA normals: labels, planes, speed\n"
      "Measures on synthetic clouds that training never uses, and times frames of the given "
      "recordings.");
  const auto args = std::make_shared<BenchClassifierArgs>();
  add_inputs(classifier, args->input, io::recordings_text(true) + ", whose frames are timed");
  classifier->remove_option(classifier->get_option("--labels"));
  add_out(classifier, args->out);
  classifier
      ->add_option("--weights", args->weights,
                   "Network to measure: gcn, the built-in one (default), or a file; repeatable")
      ->type_name("gcn|FILE")
      ->allow_extra_args(false);
  add_parts(classifier, args->parts, kClassifierParts,
            fmt::format("Parts to measure: {} (default: all, frames only with recordings)",
                        fmt::join(kClassifierParts, ", ")));
  add(classifier, "--seed", args->seed, "N", "Random seed of the clouds")->transform(whole(0));
  add(classifier, "--count", args->count, "N", "Clouds of each kind (default 100)")
      ->transform(whole(1));
  add(classifier, "--rounds", args->rounds, "N", "Repetitions of each timing (default 20)")
      ->transform(whole(1));
  add_clouds(classifier, args->input.pipeline);
  runs(classifier, line, args, run_bench_classifier, [args, &line] {
    args->command = line.text;
    finish(*args);
  });
}

}  // namespace planescope::app
