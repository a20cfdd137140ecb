#pragma once

// What the experiments measured: cells, from which every table, plot and page follows; and the
// files that keep it.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/lab/bench/measuring.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::lab {

/// Which frames were segmented, and how.
struct CellKey {
  std::string set;         // of evaluation_sets(), or "icl_nuim"
  std::uint64_t seed = 0;  // 0: not from a seed
  int points = 0;          // of clouds
  double noise_cm = 0;     // of clouds
  std::string errors;      // of depth images: "clean", "noise", "d435"
  std::string method;      // "ours", "ransac", ... as --method has it, or "oracle"
  std::string profile;     // of ours: "paper", "paper-closest", "refined"
  std::string classifier;  // of ours: "truth", "gcn", "pca", "none" (all points one label)
  std::string setting;     // what is not as usual: "theta_pf 0.02", "without bow"

  bool operator==(const CellKey&) const = default;
};

/// The mean over a set's frames. Clouds are scored by point, depth images by voxel.
struct Cell {
  CellKey key;
  int frames = 0;
  planes::Metrics metrics;
};

/// Sizes of a real recording's frames, means over them.
struct RealRow {
  std::string recording;  // its name in the list, or its folder's or file's
  int frames = 0;         // that were processed
  int refused = 0;        // no gravity
  double n_m = 0, n_d = 0;
  double planes = 0;  // found by ours
};

/// All that is the same for the same seeds, options and weights, on any machine.
struct PaperResults {
  std::string command;  // that measures the same again, without folders and threads
  report::BuildInfo build;
  planes::WeightsRecord weights;
  std::uint64_t seed = 1, tuning_seed = 1001;
  bool quick = false;
  int count = 0;  // frames of a set at most; 0: all that it has
  std::vector<Cell> cells;
  std::vector<RealRow> real;

  /// Null where it was not measured.
  const Cell* find(const CellKey& key) const;
};

/// Milliseconds of a frame, medians over a recording's frames; the paper's table IV.
struct RealTiming {
  std::string recording;
  int frames = 0;
  double t_d_ms = 0, t_c_ms = 0, t_b_ms = 0, t_s_ms = 0, fps = 0;
};
struct ClassifierTiming {
  std::string classifier;  // "gcn", "pca"
  int points = 0, threads = 0;
  double median_ms = 0;
};
/// Whole frames a second on the stairs of 8192 points.
struct MethodTiming {
  CellKey key;
  double fps = 0;
};
struct PaperTimings {
  std::string command;  // that measures the same again, without folders; threads are below
  Machine machine;
  int threads = 1;
  std::vector<ClassifierTiming> classifiers;  // table II
  std::vector<RealTiming> real;               // table IV
  std::vector<MethodTiming> methods;          // table V's frames a second
};

/// "planescope 0.2.0, commit 0f3a... with changes"
std::string to_text(const report::BuildInfo& build);
/// "gcn.safetensors (compact, 27714 parameters), SHA-256 9c2d..."
std::string to_text(const planes::WeightsRecord& weights);

/// DIR/paper.json and DIR/paper.timings.json. Throw Error naming the file.
void write_results(const std::filesystem::path& dir, const PaperResults& results);
void write_timings(const std::filesystem::path& dir, const PaperTimings& timings);
PaperResults read_results(const std::filesystem::path& dir);
PaperTimings read_timings(const std::filesystem::path& dir);

/// A cell as one line of JSON, and back, to the same bits. parse_cell() throws Error.
std::string cell_line(const Cell& cell);
Cell parse_cell(const std::string& line);

/// Cells as they are measured, so that a run that was cut short can resume where it stopped.
/// DIR/cells.jsonl: a line that tells the run, then one for each cell.
class CellLog {
 public:
  /// Throws Error where there is a run and `resume` is not set, or where it is another run: of
  /// other seeds, weights, build or size than `run`.
  CellLog(const std::filesystem::path& dir, const PaperResults& run, bool resume);

  const std::vector<Cell>& cells() const { return cells_; }  // of the run so far
  void append(std::span<const Cell> cells);
  /// The run is finished and its results are written elsewhere: removes the file.
  void finish();

 private:
  std::filesystem::path file_;
  std::vector<Cell> cells_;
};

}  // namespace planescope::lab
