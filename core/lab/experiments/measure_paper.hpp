#pragma once

// Measures what `planescope-lab bench paper` reports: runs and scores the contestants of cells, and
// times them.

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
  std::optional<EvaluationFrame> real_labelled;  // where a plan asks for it
  int threads = 1;                               // over frames
};

/// Frame `index` of a cell's set.
EvaluationFrame cell_frame(const CellKey& key, int index, const CellTools& tools);

/// Cells of the same frames, of which there are `frames`: each frame is made once for all. The same
/// for any number of threads. `progress(done, all)` counts frames; it may be empty and may throw to
/// stop.
std::vector<Cell> measure_cells(std::span<const CellKey> keys,
                                int frames,
                                const CellTools& tools,
                                const std::function<void(int, int)>& progress = {});

/// The labelled frame of ICL-NUIM's living room below a folder of recordings, nullopt where it is
/// not there. Throws Error where it is damaged.
std::optional<EvaluationFrame> read_real_labelled(const std::filesystem::path& data);

/// How long it takes: the paper's table II, and the frames a second beside table V.
struct TimingOptions {
  std::uint64_t seed = 1;             // of the stairs
  int rounds = 20;                    // whose median counts: one staircase after the other
  int threads = 1;                    // classifiers are measured on one thread and on these
  std::function<void()> before_turn;  // may be empty and may throw to stop
};

/// Adds lines "classifier_time".
void time_classifiers(const CellTools& tools, const TimingOptions& options, ResultLines& lines);
/// On one thread, each frame from its points to its planes: lines "method_time".
void time_methods(const CellTools& tools, const TimingOptions& options, ResultLines& lines);

}  // namespace planescope::lab
