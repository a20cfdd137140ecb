#pragma once

// Which plane some of a frame's measurements are on.

#include <span>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::report {

/// Which plane some of a frame's measurements are on: enough to match its planes with those of
/// another run, and small enough to be kept.
struct RegionSample {
  struct Run {
    int plane = 0;  // plane id, 0 in none, -1 not measured or cropped
    int count = 0;
    bool operator==(const Run&) const = default;
  };
  int step = 1;               // every step-th pixel of every step-th row, or point of a cloud
  int columns = 0, rows = 0;  // of a cloud one row
  std::vector<Run> runs;      // row by row

  bool operator==(const RegionSample&) const = default;
  std::vector<int> plane_of() const;  // one per sample
};

std::vector<RegionSample::Run> runs_of(std::span<const int> plane_of);
RegionSample sample_regions(const Frame& frame, const planes::FrameResult& result);

}  // namespace planescope::report
