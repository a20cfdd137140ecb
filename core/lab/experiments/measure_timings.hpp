#pragma once

// How long it takes: the paper's table II, and the frames a second beside table V.

#include <functional>
#include <vector>

#include "core/lab/experiments/measure_cells.hpp"

namespace planescope::lab {

struct TimingOptions {
  std::uint64_t seed = 1;             // of the stairs
  int rounds = 20;                    // whose median counts: one staircase after the other
  int threads = 1;                    // classifiers are measured on one thread and on these
  std::function<void()> before_turn;  // may be empty and may throw to stop
};

std::vector<ClassifierTiming> classifier_timings(const CellTools& tools,
                                                 const TimingOptions& options);
/// On one thread, each frame from its points to its planes.
std::vector<MethodTiming> method_timings(const CellTools& tools, const TimingOptions& options);

}  // namespace planescope::lab
