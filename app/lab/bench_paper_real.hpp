#pragma once

// The paper's table IV: sizes of real recordings' frames, and how long they take.

#include <functional>
#include <span>
#include <vector>

#include "app/lab/bench_paper.hpp"
#include "core/lab/experiments/results.hpp"

namespace planescope::app {

struct RealInput {
  std::string name;
  OpenInput input;
  planes::PipelineOptions options;  // of one thread
};
/// Opens all, and takes at most `frames` of each, evenly spread.
std::vector<RealInput> open_real(std::span<const PaperRecording> recordings, int frames);

/// The same for any number of threads. Throws Error where a frame cannot be read. `progress(done,
/// all)` may throw to stop.
lab::RealRow measure_real(const RealInput& real,
                          const planes::Classifier& classifier,
                          int threads,
                          const std::function<void(int, int)>& progress = {});
/// Of the frames whose gravity is known, `runs` runs.
lab::RealTiming time_real(const RealInput& real,
                          const planes::Classifier& classifier,
                          int threads,
                          int runs,
                          const std::function<void(int, int)>& progress = {});

}  // namespace planescope::app
