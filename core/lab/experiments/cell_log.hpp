#pragma once

// Cells as they are measured, so that a run that was cut short can resume where it stopped.

#include <filesystem>
#include <span>
#include <vector>

#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

/// DIR/cells.jsonl: a line that tells the run, then one for each cell.
class CellLog {
 public:
  /// Throws Error where a run lies there and `resume` is not set, or it is of another run: other
  /// seeds, weights, build or size than `run` has.
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
