#include <fmt/format.h>

#include "core/lab/bench/classifier_bench.hpp"

namespace planescope::lab {
namespace {

std::string fixed(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

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

std::string measured_on(const ClassifierBench& bench) {
  return fmt::format("{}, {} cores, {}", bench.machine.cpu, bench.machine.cores,
                     to_string(bench.machine.simd));
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
                  rounds_of(bench), measured_on(bench)),
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
                  rounds_of(bench), measured_on(bench)),
      {"network", "points", "whole", "forward", "plain", "plain / whole", "plain / forward"},
      {},
      1};
  for (const ReferenceRow& row : bench.speed->reference)
    table.rows.push_back({row.network, std::to_string(row.points), fixed(row.whole_ms, 2),
                          fixed(row.forward_ms, 2), fixed(row.plain_ms, 1),
                          fixed(row.whole_ratio, 1), fixed(row.forward_ratio, 1)});
  return table;
}

/// Nothing to do is no speed.
std::string speed(double fps) { return fps > 0 ? fixed(fps, 1) : "-"; }

Table frames_table(const ClassifierBench& bench) {
  Table table{"Whole frames",
              fmt::format("As in the paper's table IV: N_m points, N_d voxels within range, t_d "
                          "voxel grid, t_c labels, t_b octree, t_s planes, FPS of these four. "
                          "cloud: back-projection and cropping, and FPS with it; load: reading the "
                          "frame. Medians over {} runs, in ms. {}.",
                          bench.frame_rows[0].runs, measured_on(bench)),
              {"recording", "labels by", "threads", "frames", "N_m", "N_d", "planes", "load",
               "cloud", "t_d", "t_c", "t_b", "t_s", "FPS", "FPS with cloud"},
              {},
              2};
  for (const FrameRow& row : bench.frame_rows)
    table.rows.push_back({row.recording, row.classifier, std::to_string(row.threads),
                          std::to_string(row.frames), fixed(row.points, 0), fixed(row.voxels, 0),
                          fixed(row.planes, 0), fixed(row.ms.load_ms, 2), fixed(row.ms.cloud_ms, 2),
                          fixed(row.ms.t_d_ms, 2), fixed(row.ms.t_c_ms, 2), fixed(row.ms.t_b_ms, 2),
                          fixed(row.ms.t_s_ms, 2), speed(row.fps), speed(row.whole_fps)});
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

}  // namespace planescope::lab
