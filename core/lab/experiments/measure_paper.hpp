#pragma once

// Measurements of `planescope-lab bench paper`: runs, scores and times the contestants of cells.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/lab/bench/result_lines.hpp"
#include "core/lab/experiments/contest.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"

namespace planescope::lab {

/// True planes of depth images with fewer voxels are not scored.
inline constexpr int kMinTruthVoxels = 20;

struct CellTools : Labellers {
  std::optional<EvaluationFrame> real_labeled;  // if a plan includes it
  int threads = 1;                              // over frames
};

/// Frame `index` of a cell's set.
EvaluationFrame cell_frame(const CellKey& key, int index, const CellTools& tools);

/// Measures cells with the same `frames` frames, each of which is generated once for all.
/// Independent of the number of threads. `progress(done, all)` counts frames; it may be empty and
/// may throw to stop.
std::vector<Cell> measure_cells(std::span<const CellKey> keys,
                                int frames,
                                const CellTools& tools,
                                const std::function<void(int, int)>& progress = {});

/// The labeled frame of ICL-NUIM's living room below a folder of recordings; nullopt if it is
/// missing. Throws Error if it is damaged.
std::optional<EvaluationFrame> read_real_labeled(const std::filesystem::path& data);

/// Options of the timings: the paper's Table II, and the frames per second beside Table V.
struct TimingOptions {
  std::uint64_t seed = 1;             // of the stairs
  int rounds = 20;                    // for the median, each with another staircase
  int threads = 1;                    // classifiers are timed on one thread and on these
  std::function<void()> before_turn;  // may be empty and may throw to stop
};

/// Adds lines "classifier_time".
void time_classifiers(const CellTools& tools, const TimingOptions& options, ResultLines& lines);
/// On one thread, from a frame's points to its planes: lines "method_time".
void time_methods(const CellTools& tools, const TimingOptions& options, ResultLines& lines);

}  // namespace planescope::lab
