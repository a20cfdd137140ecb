#pragma once

// Measurements of `planescope-lab bench classifier`: accuracy of classifiers on clouds not used in
// any training, quality of the planes of staircases segmented by their labels, speed of
// classifiers, and times of whole frames of a recording.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/io/recording.hpp"
#include "core/model/json_fields.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/result/analyze.hpp"
#include "core/planes/segment/options.hpp"

namespace planescope::lab {

// ---- Labels ----

struct NamedClassifier {
  std::string name;  // in the tables
  std::shared_ptr<const planes::Classifier> classifier;
};

struct LabelBenchOptions {
  std::uint64_t seed = 960001;
  int count = 100;      // clouds of each set
  double tilt_deg = 0;  // also measure on clouds tilted by this angle
  int threads = 1;
};

struct LabelRow {
  std::string set;
  std::string classifier;
  planes::LabelAccuracy level;
  // Against the labels of the level cloud; empty without tilt_deg.
  planes::LabelAccuracy tilted;
};

/// Stairs of 8192 points with 0, 0.1, 0.2 and 0.3 cm of noise, and scans of composed and named
/// scenes: a row for each set and classifier. Independent of the number of threads. `progress` as
/// in work_through().
std::vector<LabelRow> measure_labels(std::span<const NamedClassifier> classifiers,
                                     const LabelBenchOptions& options,
                                     const std::function<void(int, int)>& progress = {});

/// Rotates the cloud by exactly `angle_deg` about a horizontal axis of random direction.
planes::LabeledCloud tilted(const planes::LabeledCloud& cloud,
                            double angle_deg,
                            std::uint64_t seed);

/// Planes of staircases labeled by a classifier.
struct ChainRow {
  double noise_cm = 0;
  std::string labels;       // "truth", or a classifier's name
  planes::Metrics metrics;  // mean_of() all staircases
};

/// The staircases of 8192 points with 0, 0.1, 0.2 and 0.3 cm of noise of measure_labels(), through
/// the whole pipeline without a voxel grid: a row for each noise and classifier, the true labels
/// first. Independent of the number of threads.
std::vector<ChainRow> measure_chain(std::span<const NamedClassifier> classifiers,
                                    const planes::SegmentOptions& segment,
                                    const LabelBenchOptions& options,
                                    const std::function<void(int, int)>& progress = {});

// ---- Speed of networks on every instruction set, PCA normals, and a plain implementation ----

struct BenchNetwork {
  std::string name;  // in the tables
  planes::NetworkWeights weights;
};

struct SpeedBenchOptions {
  std::uint64_t seed = 960001;
  int rounds = 20;  // for the median
  int threads = 1;  // "all cores": measured with one and with these
};

/// Different staircases with 0.1 cm of noise, from points to labels and margins.
struct SpeedRow {
  std::string network;
  int points = 0, threads = 1;
  std::vector<std::pair<Simd, double>> network_ms;  // the widest instruction set last
  double nanoflann_ms = 0, pca_ms = 0;              // PCA with 16 neighbors, nanoflann's and ours
  double nanoflann_ratio = 0, pca_ratio = 0;        // as multiples of the network's time
};
void visit_fields(auto& fields, Same<SpeedRow> auto& row) {
  fields("network", row.network);
  fields("points", row.points);
  fields("threads", row.threads);
  fields.object("network_ms", kPlain, [&](auto& sets) {
    for (const auto& [simd, ms] : row.network_ms) sets(to_string(simd).c_str(), ms);
  });
  fields("nanoflann_pca_ms", row.nanoflann_ms);
  fields("own_pca_ms", row.pca_ms);
  fields("nanoflann_pca_by_network", row.nanoflann_ratio);
  fields("own_pca_by_network", row.pca_ratio);
}

/// On one thread. The plain forward pass gets its neighbors and does not search.
struct ReferenceRow {
  std::string network;
  int points = 0;
  double whole_ms = 0;    // neighbor search and forward pass
  double forward_ms = 0;  // the forward pass on an existing graph
  double plain_ms = 0;
  double whole_ratio = 0, forward_ratio = 0;  // time of the plain one as a multiple
};
void visit_fields(auto& fields, Same<ReferenceRow> auto& row) {
  fields("network", row.network);
  fields("points", row.points);
  fields("whole_ms", row.whole_ms);
  fields("forward_ms", row.forward_ms);
  fields("plain_ms", row.plain_ms);
  fields("plain_by_whole", row.whole_ratio);
  fields("plain_by_forward", row.forward_ratio);
}

struct SpeedBench {
  std::vector<SpeedRow> speed;
  std::vector<ReferenceRow> reference;  // of the first network
};

/// 2048, 4096 and 8192 points. All contestants of a row run interleaved. `progress` is called with
/// the number of finished turns and of all turns; it may be empty and may throw to stop.
SpeedBench measure_speed(std::span<const BenchNetwork> networks,
                         const SpeedBenchOptions& options,
                         const std::function<void(int, int)>& progress = {});

// ---- Whole frames, as in Table IV of the paper ----

/// Medians over runs of frames.
struct FrameRow {
  int threads = 1;
  int frames = 0, runs = 0;  // distinct frames, and runs in total
  double points = 0;         // measured, including those out of range
  double voxels = 0, planes = 0;
  planes::FrameTimings ms;
  double fps = 0;        // as in the paper, from t_d + t_c + t_b + t_s; 0 if nothing is in range
  double whole_fps = 0;  // including back-projection and cropping, but not loading
};
void visit_fields(auto& fields, Same<FrameRow> auto& row) {
  fields("threads", row.threads);
  fields("frames", row.frames);
  fields("runs", row.runs);
  fields("points", row.points);
  fields("voxels", row.voxels);
  fields("planes", row.planes);
  fields("ms", row.ms);
  fields("fps", row.fps);
  fields("fps_with_cloud", row.whole_fps);
}

/// Up to `runs` of `frames`, evenly spaced; if there are fewer, each is run several times. Excludes
/// a few warm-up runs. Loads frames again for each run. `options.threads` as given. Throws Error if
/// a frame cannot be read or has no gravity. `progress` is called before each run with its number
/// and the total; it may be empty and may throw to stop.
FrameRow measure_frames(const io::Recording& recording,
                        const std::vector<int>& frames,
                        const planes::PipelineOptions& options,
                        const planes::Classifier& classifier,
                        const std::function<void(int, int)>& progress = {},
                        int runs = 30);

}  // namespace planescope::lab
