#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/lab/bench/speed_page.hpp"

namespace planescope::lab {
namespace {

/// Three digits that count: 0.0312, 3.12, 312.
std::string ms_text(double ms) {
  if (!std::isfinite(ms)) return "-";
  if (ms <= 0) return "0";
  return fixed(ms, std::clamp(2 - static_cast<int>(std::floor(std::log10(ms))), 0, 4));
}

std::string ratio_text(double ratio) { return std::isfinite(ratio) ? ms_text(ratio) + "x" : "-"; }

/// 1234567 as 1,234,567.
std::string count_text(std::uint64_t count) {
  const std::string digits = std::to_string(count);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string exponent_text(double exponent) {
  return std::isfinite(exponent) ? fixed(exponent, 2) : "-";
}

std::string calls_text(const std::optional<Allocations>& allocations) {
  return allocations ? count_text(allocations->calls) : "-";
}

std::string mib_text(const std::optional<Allocations>& allocations) {
  return allocations ? fixed(static_cast<double>(allocations->bytes) / (1 << 20), 2) : "-";
}

Table memory_table(const char* title, const char* first, const char* note) {
  Table table;
  table.title = title;
  table.note = note;
  table.columns = {"recording", first, "allocations", "MiB allocated"};
  table.names = 2;
  return table;
}

}  // namespace

Table stage_table(const ChainSpeed& speed) {
  Table table;
  table.title = "Stages beside their floors";
  table.columns = {"recording", "stage",    "ms",       "least",
                   "greatest",  "floor ms", "bound by", "ratio"};
  table.names = 2;
  for (const StageRow& row : speed.stages)
    table.rows.push_back({row.recording, row.stage, ms_text(row.ms.median), ms_text(row.ms.least),
                          ms_text(row.ms.greatest), ms_text(row.floor.ms),
                          row.floor.by_bytes ? "bytes" : "flops", ratio_text(row.ratio)});
  table.note = fmt::format(
      "CPU time of one thread, medians over {} rounds of all stages in turn. A floor is the larger "
      "of two times: bytes at {:.1f} GB/s, as memcpy moves 64 MiB, and sums at {:.0f} GFLOP/s, "
      "multiplications and additions in registers of the widest instruction set, not fused. Bytes: "
      "each input read once, each output written once; a pixel of depth 2, a point 12, an index 4, "
      "a label 1. Flops: cloud 17 for each point; voxel grid 9, and 3 for each voxel; pca 15 for "
      "each neighbour; gcn its matrices and 6 for each kernel and neighbour; octree 6, "
      "segmentation "
      "15 for each voxel. Searches, sorting and branches count nothing. The segmentations go from "
      "labels to the planes of pixels and have the octree in them.",
      speed.rounds, speed.peaks.bytes_per_s * 1e-9, speed.peaks.flops_per_s * 1e-9);
  return table;
}

Table duel_table(const ChainSpeed& speed) {
  Table table;
  table.title = "Stages beside those of other libraries";
  table.columns = {"recording", "stage", "beside", "ours ms", "theirs ms", "theirs of ours"};
  table.names = 3;
  for (const DuelRow& row : speed.duels)
    table.rows.push_back({row.recording, row.stage, row.rival, ms_text(row.ours_ms.median),
                          ms_text(row.rival_ms.median), ratio_text(row.ratio)});
  table.note =
      "CPU time of one thread, medians of both in turn. Their input is in their own types before. "
      "Ours makes an octree's nodes where it looks at them; here it makes all, as Open3D does.";
  return table;
}

Table method_table(const ChainSpeed& speed) {
  Table table;
  table.title = "Whole frames, from depth to the planes of pixels";
  table.columns = {"recording", "method", "ms", "least", "greatest", "of region growing", "planes"};
  table.names = 2;
  for (const MethodRow& row : speed.methods)
    table.rows.push_back({row.recording, row.method, ms_text(row.ms.median), ms_text(row.ms.least),
                          ms_text(row.ms.greatest), ratio_text(row.ratio), fixed(row.planes, 0)});
  table.note = fmt::format(
      "CPU time of the process, one thread, medians over {} rounds of all methods in turn, each "
      "round on the next frame. Region growing on cells of 20 px is the CAPE-style method that is "
      "1x; of the others the median of ratios taken side by side. All begin with the frame in "
      "memory: gravity, cloud and voxel grid are in every time.",
      speed.rounds);
  return table;
}

Table scaling_table(const Scaling& scaling) {
  Table table;
  table.title = scaling.title + ": milliseconds, and the exponent of their growth";
  table.note = scaling.note + fmt::format(" Medians in ms, {}.", to_string(scaling.clock));
  table.columns = {scaling.x_name};
  for (const double x : scaling.x) table.columns.push_back(fmt::format("{:.4g}", x));
  table.columns.push_back("exponent");
  for (const ScalingCurve& curve : scaling.curves) {
    std::vector<std::string> row = {curve.name};
    for (const double ms : curve.ms) row.push_back(ms_text(ms));
    row.push_back(exponent_text(curve.exponent));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Table> memory_tables(const ChainSpeed& speed) {
  Table stages = memory_table("Allocations of a frame, by stage", "stage",
                              "On one thread, of a frame that ran twice before: what is kept from "
                              "frame to frame is there. Dashes: this build does not count.");
  for (const StageRow& row : speed.stage_memory)
    stages.rows.push_back(
        {row.recording, row.stage, calls_text(row.allocations), mib_text(row.allocations)});
  Table methods = memory_table("Allocations of a whole frame, by method", "method",
                               "Peak: the most that the process had resident while the frame "
                               "ran, beyond what it had before.");
  methods.columns.push_back("peak MiB");
  for (const MethodRow& row : speed.method_memory)
    methods.rows.push_back({row.recording, row.method, calls_text(row.allocations),
                            mib_text(row.allocations),
                            row.peak_mib > 0 ? fixed(row.peak_mib, 0) : "-"});
  return {stages, methods};
}

Table command_table(const ChainSpeed& speed) {
  Table table;
  table.title = "Whole commands, from start to end";
  table.columns = {"command", "ms", "least", "greatest", "CPU ms", "peak MiB"};
  for (const CommandRow& row : speed.commands)
    table.rows.push_back({row.name, ms_text(row.wall_ms.median), ms_text(row.wall_ms.least),
                          ms_text(row.wall_ms.greatest), ms_text(row.cpu_ms.median),
                          fixed(row.peak_mib, 0)});
  table.note = fmt::format(
      "Wall clock, medians over {} rounds of all commands in turn; files are in the system's "
      "cache. "
      "`--version` is what it costs to start the program.",
      speed.rounds);
  return table;
}

}  // namespace planescope::lab
