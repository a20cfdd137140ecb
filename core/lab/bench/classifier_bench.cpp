#include "core/lab/bench/classifier_bench.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/lab/bench/result_json.hpp"

namespace planescope::lab {

// ---- Tables ----

namespace {

std::string clouds_of(const ClassifierBench& bench) {
  return fmt::format("{} clouds of each kind, seed {}", bench.labels.count, bench.labels.seed);
}

Table accuracy_table(const ClassifierBench& bench) {
  Table table{
      "Labels that are right",
      fmt::format(
          "Percent of the points within 2 cm of a tread, riser or pixel of the other label (edge), "
          "and of all others (inner). {}.",
          clouds_of(bench)),
      {"clouds", "labels by", "edge %", "inner %"},
      {},
      2};
  for (const LabelRow& row : bench.label_rows)
    table.rows.push_back({row.set, row.classifier, fixed(row.level.edge_percent(), 2),
                          fixed(row.level.inner_percent(), 2)});
  return table;
}

Table gravity_table(const ClassifierBench& bench) {
  const std::string off = fmt::format("{} deg off", bench.labels.tilt_deg);
  Table table{fmt::format("Gravity wrong by {} degrees", bench.labels.tilt_deg),
              fmt::format("Edge labels that are right on the same clouds, level and turned about "
                          "random level axes. {}.",
                          clouds_of(bench)),
              {"clouds", "labels by", "level %", off + " %", "lost"},
              {},
              2};
  for (const LabelRow& row : bench.label_rows) {
    const double level = row.level.edge_percent(), tilted = row.tilted.edge_percent();
    table.rows.push_back(
        {row.set, row.classifier, fixed(level, 2), fixed(tilted, 2), fixed(level - tilted, 2)});
  }
  return table;
}

Table chain_table(const ClassifierBench& bench) {
  Table table{"The planes that follow",
              fmt::format("Staircases of 8192 points through the whole pipeline, no voxel grid. "
                          "r_p: 100 x planes found / true; points: % in the matching plane; alpha: "
                          "mean angle to the true normal; r_m: % of points in no plane. {} "
                          "staircases, seed {}.",
                          bench.labels.count, bench.labels.seed),
              {"noise", "labels by", "r_p", "points %", "alpha deg", "r_m %"},
              {},
              2};
  for (const ChainRow& row : bench.chain_rows)
    table.rows.push_back({fmt::format("{} cm", row.noise_cm), row.labels, fixed(row.metrics.r_p, 2),
                          fixed(row.metrics.point_accuracy, 2), fixed(row.metrics.alpha_deg, 3),
                          fixed(row.metrics.r_m, 2)});
  return table;
}

std::string rounds_of(const ClassifierBench& bench) {
  return fmt::format("Medians of {} rounds in which all take turns", bench.speed_options.rounds);
}

Table speed_table(const ClassifierBench& bench) {
  Table table{
      "From points to labels",
      fmt::format("{}. Times in ms; ratios: how often the time of the network on the widest "
                  "instruction set. PCA with 16 neighbours. nanoflann's tree is built on "
                  "one thread, as its version here has it. {}.",
                  rounds_of(bench), to_text(bench.machine)),
      {"network", "points", "threads"},
      {},
      1};
  for (const auto& [simd, ms] : bench.speed->speed[0].network_ms)
    table.columns.push_back(to_string(simd));
  for (const char* column : {"nanoflann PCA", "own PCA", "nanoflann / network", "own / network"})
    table.columns.emplace_back(column);
  for (const SpeedRow& row : bench.speed->speed) {
    auto& cells = table.rows.emplace_back();
    cells = {row.network, std::to_string(row.points), std::to_string(row.threads)};
    for (const auto& [simd, ms] : row.network_ms) cells.push_back(fixed(ms, 2));
    for (const double value : {row.nanoflann_ms, row.pca_ms, row.nanoflann_ratio, row.pca_ratio})
      cells.push_back(fixed(value, 2));
  }
  return table;
}

Table reference_table(const ClassifierBench& bench) {
  Table table{
      "Against the same network written plainly",
      fmt::format("{}, on one thread. Times in ms. The plain forward is given its "
                  "neighbours; whole: ours with its search for them, forward: without. {}.",
                  rounds_of(bench), to_text(bench.machine)),
      {"network", "points", "whole", "forward", "plain", "plain / whole", "plain / forward"},
      {},
      1};
  for (const ReferenceRow& row : bench.speed->reference)
    table.rows.push_back({row.network, std::to_string(row.points), fixed(row.whole_ms, 2),
                          fixed(row.forward_ms, 2), fixed(row.plain_ms, 1),
                          fixed(row.whole_ratio, 1), fixed(row.forward_ratio, 1)});
  return table;
}

Table frames_table(const ClassifierBench& bench) {
  Table table{"Whole frames",
              fmt::format("As in the paper's table IV: N_m points, N_d voxels within range, t_d "
                          "voxel grid, t_c labels, t_b octree, t_s planes, FPS of these four. "
                          "cloud: back-projection and cropping, and FPS with it; load: reading the "
                          "frame. Medians over {} runs, in ms. {}.",
                          bench.frame_rows[0].runs, to_text(bench.machine)),
              {"recording", "labels by", "threads", "frames", "N_m", "N_d", "planes", "load",
               "cloud", "t_d", "t_c", "t_b", "t_s", "FPS", "FPS with cloud"},
              {},
              2};
  for (const FrameRow& row : bench.frame_rows)
    table.rows.push_back({row.recording, row.classifier, std::to_string(row.threads),
                          std::to_string(row.frames), fixed(row.points, 0), fixed(row.voxels, 0),
                          fixed(row.planes, 0), fixed(row.ms.load_ms, 2), fixed(row.ms.cloud_ms, 2),
                          fixed(row.ms.t_d_ms, 2), fixed(row.ms.t_c_ms, 2), fixed(row.ms.t_b_ms, 2),
                          fixed(row.ms.t_s_ms, 2), speed_text(row.fps), speed_text(row.whole_fps)});
  return table;
}

}  // namespace

std::vector<Table> result_tables(const ClassifierBench& bench) {
  std::vector<Table> tables;
  if (bench.accuracy) tables.push_back(accuracy_table(bench));
  if (bench.gravity) tables.push_back(gravity_table(bench));
  if (!bench.chain_rows.empty()) tables.push_back(chain_table(bench));
  return tables;
}

std::vector<Table> timing_tables(const ClassifierBench& bench) {
  std::vector<Table> tables;
  if (bench.speed) {
    tables.push_back(speed_table(bench));
    tables.push_back(reference_table(bench));
  }
  if (!bench.frame_rows.empty()) tables.push_back(frames_table(bench));
  return tables;
}

// ---- JSON ----

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const planes::LabelAccuracy& accuracy) {
  return {{"edge_percent", accuracy.edge_percent()},
          {"inner_percent", accuracy.inner_percent()},
          {"edge_points", accuracy.edge},
          {"inner_points", accuracy.inner}};
}

Json json_of(const SpeedRow& row) {
  Json json = {{"network", row.network}, {"points", row.points}, {"threads", row.threads}};
  for (const auto& [simd, ms] : row.network_ms) json["network_ms"][to_string(simd)] = ms;
  json["nanoflann_pca_ms"] = row.nanoflann_ms;
  json["own_pca_ms"] = row.pca_ms;
  json["nanoflann_pca_by_network"] = row.nanoflann_ratio;
  json["own_pca_by_network"] = row.pca_ratio;
  return json;
}

Json json_of(const ReferenceRow& row) {
  return {{"network", row.network},
          {"points", row.points},
          {"whole_ms", row.whole_ms},
          {"forward_ms", row.forward_ms},
          {"plain_ms", row.plain_ms},
          {"plain_by_whole", row.whole_ratio},
          {"plain_by_forward", row.forward_ratio}};
}

Json json_of(const FrameRow& row) {
  return {{"recording", row.recording},
          {"classifier", row.classifier},
          {"threads", row.threads},
          {"frames", row.frames},
          {"runs", row.runs},
          {"points", row.points},
          {"voxels", row.voxels},
          {"planes", row.planes},
          {"load_ms", row.ms.load_ms},
          {"cloud_ms", row.ms.cloud_ms},
          {"t_d_ms", row.ms.t_d_ms},
          {"t_c_ms", row.ms.t_c_ms},
          {"t_b_ms", row.ms.t_b_ms},
          {"t_s_ms", row.ms.t_s_ms},
          {"fps", row.fps},
          {"fps_with_cloud", row.whole_fps}};
}

}  // namespace

std::string results_json(const ClassifierBench& bench) {
  Json json = {{"schema", "planescope.bench_classifier/1"},
               {"seed", bench.labels.seed},
               {"count", bench.labels.count}};
  json["networks"] = Json::array();
  for (const auto& [name, record] : bench.networks)
    json["networks"].push_back({{"name", name},
                                {"file", record.file},
                                {"sha256", record.sha256},
                                {"network", record.network},
                                {"training", Json::parse(record.training)}});
  if (bench.gravity) json["tilt_deg"] = bench.labels.tilt_deg;
  for (const LabelRow& row : bench.label_rows) {
    Json entry = {{"clouds", row.set}, {"classifier", row.classifier}};
    entry["level"] = json_of(row.level);
    if (bench.gravity) entry["tilted"] = json_of(row.tilted);
    json["labels"].push_back(entry);
  }
  for (const ChainRow& row : bench.chain_rows)
    json["chain"].push_back({{"noise_cm", row.noise_cm},
                             {"labels", row.labels},
                             {"planes_true", row.metrics.planes_truth},
                             {"planes_found", row.metrics.planes_found},
                             {"r_p", row.metrics.r_p},
                             {"point_accuracy", row.metrics.point_accuracy},
                             {"alpha_deg", row.metrics.alpha_deg},
                             {"r_m", row.metrics.r_m}});
  return json_text(json);
}

std::string timings_json(const ClassifierBench& bench) {
  Json json = {{"schema", "planescope.bench_classifier.timings/1"},
               {"command", bench.command},
               {"machine", machine_json(bench.machine)}};
  if (bench.speed) {
    json["seed"] = bench.speed_options.seed;
    json["rounds"] = bench.speed_options.rounds;
    for (const SpeedRow& row : bench.speed->speed) json["speed"].push_back(json_of(row));
    for (const ReferenceRow& row : bench.speed->reference)
      json["reference"].push_back(json_of(row));
  }
  for (const FrameRow& row : bench.frame_rows) json["frames"].push_back(json_of(row));
  return json_text(json);
}

}  // namespace planescope::lab
