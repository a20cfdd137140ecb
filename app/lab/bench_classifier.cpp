#include "app/lab/bench_classifier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/cli/assets.hpp"
#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "core/lab/bench/classifier_bench.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

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

std::string joined(const std::vector<lab::Table>& tables, std::string (*text)(const lab::Table&)) {
  std::string all;
  for (const lab::Table& table : tables) {
    if (!all.empty()) all += '\n';
    all += text(table);
  }
  return all;
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

}  // namespace

const std::vector<std::string>& bench_classifier_parts() {
  static const std::vector<std::string> parts = {"accuracy", "gravity", "chain", "speed", "frames"};
  return parts;
}

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

}  // namespace planescope::app
