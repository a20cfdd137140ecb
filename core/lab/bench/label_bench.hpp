#pragma once

// How many labels classifiers get right on clouds that no training has seen, and what becomes of
// the planes of staircases that are segmented by those labels.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/planes/classify/classifier.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/segment/options.hpp"

namespace planescope::lab {

struct NamedClassifier {
  std::string name;  // in the tables
  std::shared_ptr<const planes::Classifier> classifier;
};

struct LabelBenchOptions {
  std::uint64_t seed = 960001;
  int count = 100;      // clouds of each set
  double tilt_deg = 0;  // also measured on clouds tilted by this much
  int threads = 1;
};

struct LabelRow {
  std::string set;
  std::string classifier;
  planes::LabelAccuracy level;
  // Against the labels of the level cloud; nothing counted without tilt_deg.
  planes::LabelAccuracy tilted;
};

/// Stairs of 8192 points with 0, 0.1, 0.2 and 0.3 cm of noise, and scans of composed scenes and of
/// the named ones: a row for each set and classifier. The same for any number of threads.
/// `progress` as in work_through().
std::vector<LabelRow> measure_labels(std::span<const NamedClassifier> classifiers,
                                     const LabelBenchOptions& options,
                                     const std::function<void(int, int)>& progress = {});

/// The cloud turned by exactly `angle_deg` about a level axis of random direction.
planes::LabelledCloud tilted(const planes::LabelledCloud& cloud,
                             double angle_deg,
                             std::uint64_t seed);

/// The planes of staircases whose points a classifier labelled.
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
