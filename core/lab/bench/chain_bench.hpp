#pragma once

// What the planes of staircases become when a classifier labels their points.

#include "core/lab/bench/label_bench.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/segment/options.hpp"

namespace planescope::lab {

struct ChainRow {
  double noise_cm = 0;
  std::string labels;       // "truth", or a classifier's name
  planes::Metrics metrics;  // mean_of() all staircases
};

/// Staircases of 8192 points with 0, 0.1, 0.2 and 0.3 cm of noise, as measure_labels() has them,
/// through the whole pipeline without a voxel grid: a row for each noise and classifier, the true
/// labels first. The same for any number of threads.
std::vector<ChainRow> measure_chain(std::span<const NamedClassifier> classifiers,
                                    const planes::SegmentOptions& segment,
                                    const LabelBenchOptions& options,
                                    const std::function<void(int, int)>& progress = {});

}  // namespace planescope::lab
