// Tables II and IV, and the frames a second beside table V.

#include "core/lab/experiments/cell_figures.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/printed.hpp"

namespace planescope::lab {
namespace {

/// A dash where there was nothing to time.
std::string speed(double fps) { return fps > 0 ? fixed(fps, 1) : "-"; }

std::string measured_on(const PaperTimings& timings) {
  return fmt::format("{}, {} cores, {}", timings.machine.cpu, timings.machine.cores,
                     to_string(timings.machine.simd));
}

Table classifier_table(const PaperTimings& timings) {
  Table table{"Table II: classifier time [ms]",
              fmt::format("Medians of rounds in which all take turns, on the stairs. {}. The "
                          "paper's was measured on a GPU.",
                          measured_on(timings)),
              {"labels by", "threads"},
              {},
              2};
  std::vector<std::string> printed = {"printed (3D-GCN, RTX 3090)", "-"};
  for (const PrintedClassifierTime& time : printed_classifier_times()) {
    table.columns.push_back(fmt::format("{} points", time.points));
    printed.push_back(fixed(time.ms, 0));
  }
  table.rows.push_back(printed);
  for (const ClassifierTiming& first : timings.classifiers) {
    if (first.points != printed_classifier_times()[0].points) continue;
    std::vector<std::string> row = {first.classifier, std::to_string(first.threads)};
    for (const PrintedClassifierTime& time : printed_classifier_times())
      for (const ClassifierTiming& other : timings.classifiers)
        if (other.classifier == first.classifier && other.threads == first.threads &&
            other.points == time.points)
          row.push_back(fixed(other.median_ms, 2));
    row.resize(table.columns.size(), "-");
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table real_table(const PaperTimings& timings) {
  Table table{"Table IV: times of real data [ms]",
              fmt::format("t_d voxel grid, t_c labels (gcn), t_b octree, t_s planes (refined), FPS "
                          "of these four; medians over the frames, {} threads. {}.",
                          timings.threads, measured_on(timings)),
              {"recording", "frames", "t_d", "t_c", "t_b", "t_s", "FPS"},
              {},
              1};
  for (const PrintedReal& row : printed_real())
    table.rows.push_back({"printed, " + row.scene, "-", fixed(row.t_d_ms, 1), fixed(row.t_c_ms, 1),
                          fixed(row.t_b_ms, 1), fixed(row.t_s_ms, 1), speed(row.fps)});
  for (const RealTiming& row : timings.real)
    table.rows.push_back({row.recording, std::to_string(row.frames), fixed(row.t_d_ms, 2),
                          fixed(row.t_c_ms, 2), fixed(row.t_b_ms, 2), fixed(row.t_s_ms, 2),
                          speed(row.fps)});
  return table;
}

Table method_table(const PaperTimings& timings) {
  Table table{
      "Table V: frames a second",
      fmt::format("Whole frames of the stairs, 8192 points with {} cm of noise, from points "
                  "to planes on one thread; medians of rounds in which all take turns. {}.",
                  timings.methods[0].key.noise_cm, measured_on(timings)),
      {"method", "FPS"},
      {},
      1};
  for (const PrintedFps& printed : printed_fps())
    table.rows.push_back({"printed, " + printed.method, fixed(printed.fps, 1)});
  for (const MethodTiming& method : timings.methods)
    table.rows.push_back({contestant_name(method.key), speed(method.fps)});
  return table;
}

}  // namespace

std::vector<Table> timing_tables(const PaperTimings& timings) {
  std::vector<Table> tables;
  if (!timings.classifiers.empty()) tables.push_back(classifier_table(timings));
  if (!timings.real.empty()) tables.push_back(real_table(timings));
  if (!timings.methods.empty()) tables.push_back(method_table(timings));
  return tables;
}

}  // namespace planescope::lab
