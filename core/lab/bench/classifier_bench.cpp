// Classifier benchmark: accuracy on clouds, effect on planes, and speed.

#include "core/lab/bench/classifier_bench.hpp"

#include <array>
#include <chrono>
#include <memory>

#include "core/lab/bench/measuring.hpp"
#include "core/lab/rivals/rivals.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/lab/training/training_set.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/classify/gcn.hpp"
#include "core/planes/classify/gcn_forward.hpp"
#include "core/planes/classify/neighbour_grid.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {

// ---- Labels ----

namespace {

enum Stream : std::uint64_t { kTiltAxis = 301, kTiltOfSet = 302 };

struct Set {
  const char* name;
  planes::LabeledCloud (*make)(std::uint64_t seed, int index);
};

planes::LabeledCloud stairs(double noise_m, std::uint64_t seed, int index) {
  return labeled(make_stairs(index, {.seed = seed, .noise_m = noise_m}));
}

const std::array<Set, 6> kSets = {{
    {"stairs, 0 cm", [](std::uint64_t seed, int index) { return stairs(0, seed, index); }},
    {"stairs, 0.1 cm", [](std::uint64_t seed, int index) { return stairs(0.001, seed, index); }},
    {"stairs, 0.2 cm", [](std::uint64_t seed, int index) { return stairs(0.002, seed, index); }},
    {"stairs, 0.3 cm", [](std::uint64_t seed, int index) { return stairs(0.003, seed, index); }},
    {"scans of composed scenes",
     [](std::uint64_t seed, int index) { return make_composed_test_scan(seed, index); }},
    {"scans of named scenes",
     [](std::uint64_t seed, int index) { return make_test_scan(seed, index); }},
}};

planes::LabelAccuracy accuracy_on(const planes::LabeledCloud& cloud,
                                  const planes::Classifier& classifier) {
  return planes::label_accuracy(cloud, classifier.classify(cloud.points, 1).labels);
}

}  // namespace

planes::LabeledCloud tilted(const planes::LabeledCloud& cloud,
                            double angle_deg,
                            std::uint64_t seed) {
  const double azimuth_deg = 360 * random_uniform(seed, kTiltAxis, 0);
  const Mat3d turn = rotation({cos_deg(azimuth_deg), sin_deg(azimuth_deg), 0}, angle_deg);
  planes::LabeledCloud turned = cloud;
  for (Vec3f& p : turned.points) p = (turn * p.cast<double>()).cast<float>();
  return turned;
}

std::vector<LabelRow> measure_labels(std::span<const NamedClassifier> classifiers,
                                     const LabelBenchOptions& options,
                                     const std::function<void(int, int)>& progress) {
  const auto count = static_cast<std::size_t>(options.count), n = classifiers.size();
  std::vector<LabelRow> of_cloud(kSets.size() * count * n);  // [sets][clouds][classifiers]
  const auto measure = [&](int number) {
    const auto work = static_cast<std::size_t>(number);
    const planes::LabeledCloud cloud =
        kSets[work / count].make(options.seed, static_cast<int>(work % count));
    const std::uint64_t tilt_seed = random_bits(options.seed, kTiltOfSet, work);
    const planes::LabeledCloud off = tilted(cloud, options.tilt_deg, tilt_seed);
    for (std::size_t c = 0; c < n; ++c) {
      const planes::Classifier& classifier = *classifiers[c].classifier;
      of_cloud[work * n + c].level = accuracy_on(cloud, classifier);
      if (options.tilt_deg != 0) of_cloud[work * n + c].tilted = accuracy_on(off, classifier);
    }
  };
  work_through(static_cast<int>(kSets.size() * count), options.threads, measure, progress);

  std::vector<LabelRow> rows;
  for (std::size_t s = 0; s < kSets.size(); ++s)
    for (std::size_t c = 0; c < n; ++c) {
      LabelRow& row = rows.emplace_back();
      row.set = kSets[s].name;
      row.classifier = classifiers[c].name;
      for (std::size_t i = 0; i < count; ++i) {
        row.level += of_cloud[(s * count + i) * n + c].level;
        row.tilted += of_cloud[(s * count + i) * n + c].tilted;
      }
    }
  return rows;
}

// ---- The resulting planes ----

std::vector<ChainRow> measure_chain(std::span<const NamedClassifier> classifiers,
                                    const planes::SegmentOptions& segment,
                                    const LabelBenchOptions& options,
                                    const std::function<void(int, int)>& progress) {
  constexpr double kNoiseCm[] = {0, 0.1, 0.2, 0.3};
  planes::PipelineOptions pipeline;
  pipeline.segment = segment;
  pipeline.cloud.voxel_size_m = 0;

  const auto count = static_cast<std::size_t>(options.count), n = classifiers.size() + 1;
  // [noises][labels][stairs], so that those of a row are adjacent
  std::vector<planes::Metrics> of_stairs(std::size(kNoiseCm) * n * count);
  const auto measure = [&](int number) {
    const auto work = static_cast<std::size_t>(number);
    const std::size_t noise = work / count, i = work % count;
    Stairs stairs =
        make_stairs(static_cast<int>(i), {.seed = options.seed, .noise_m = kNoiseCm[noise] / 100});
    planes::SourceTruth truth = *planes::truth_of_cloud(stairs.cloud);
    truth.normals = stairs.normals;
    Frame frame;
    frame.cloud = std::move(stairs.cloud);
    const planes::FrameTruth on_points =
        planes::truth_on_points(truth.values, planes::measured_sources(frame));
    for (std::size_t c = 0; c < n; ++c) {
      const planes::Classifier* classifier = c > 0 ? classifiers[c - 1].classifier.get() : nullptr;
      of_stairs[(noise * n + c) * count + i] =
          planes::score_frame(planes::run_frame(frame, pipeline, classifier, &on_points), truth);
    }
  };
  work_through(static_cast<int>(std::size(kNoiseCm) * count), options.threads, measure, progress);

  std::vector<ChainRow> rows;
  for (std::size_t noise = 0; noise < std::size(kNoiseCm); ++noise)
    for (std::size_t c = 0; c < n; ++c)
      rows.push_back(
          {kNoiseCm[noise], c > 0 ? classifiers[c - 1].name : "truth",
           planes::mean_of(std::span(of_stairs).subspan((noise * n + c) * count, count))});
  return rows;
}

// ---- Speed ----

namespace {

using Points = std::vector<Vec3f>;

constexpr int kSizes[] = {2048, 4096, 8192};
constexpr int kStairs = 3;  // used alternately

/// The instruction sets of this machine, the widest last.
std::vector<Simd> instruction_sets() {
  std::vector<Simd> sets;
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512})
    if (simd <= best_simd()) sets.push_back(simd);
  return sets;
}

std::vector<Points> make_clouds(int points, std::uint64_t seed) {
  std::vector<Points> clouds;
  for (int i = 0; i < kStairs; ++i)
    clouds.push_back(
        make_stairs(i, {.seed = seed, .points = points, .noise_m = 0.001}).cloud.points);
  return clouds;
}

/// Counts turns over all contests.
class Turns {
 public:
  Turns(int all, const std::function<void(int, int)>& progress) : all_(all), progress_(progress) {}
  void next() {
    if (progress_) progress_(done_++, all_);
  }

 private:
  int done_ = 0, all_;
  const std::function<void(int, int)>& progress_;
};

SpeedRow race(const BenchNetwork& network,
              const std::vector<Points>& clouds,
              int rounds,
              int threads,
              Turns& turns) {
  std::vector<std::unique_ptr<planes::Classifier>> classifiers;
  const std::vector<Simd> sets = instruction_sets();
  for (const Simd simd : sets)
    classifiers.push_back(planes::make_gcn_classifier(network.weights, network.name, simd));
  const planes::PcaClassifierOptions pca{.neighbors = 16};
  classifiers.push_back(make_nanoflann_pca_classifier(pca));
  classifiers.push_back(planes::make_pca_classifier(pca));

  const auto ms = interleaved_ms(
      classifiers.size(), rounds, [&] { turns.next(); },
      [&](std::size_t who, int round) {
        classifiers[who]->classify(clouds[static_cast<std::size_t>(round % kStairs)], threads);
      });
  SpeedRow row{network.name, static_cast<int>(clouds[0].size()), threads, {}};
  for (std::size_t s = 0; s < sets.size(); ++s) row.network_ms.emplace_back(sets[s], median(ms[s]));
  const auto &best = ms[sets.size() - 1], &nanoflann = ms[sets.size()], &ours = ms[sets.size() + 1];
  row.nanoflann_ms = median(nanoflann);
  row.pca_ms = median(ours);
  row.nanoflann_ratio = median_ratio(nanoflann, best);
  row.pca_ratio = median_ratio(ours, best);
  return row;
}

ReferenceRow race_reference(const BenchNetwork& network,
                            const Points& cloud,
                            int rounds,
                            Turns& turns) {
  const planes::NetworkConfig& config = network.weights.config;
  const Simd simd = best_simd();
  const planes::NeighborGrid grid(cloud, config.neighbors + 1);
  const std::span<const Vec3f> points = grid.points();  // pooling depends on this order
  const PlainGraph plain_graph = make_plain_graph(points, config);
  const PlainNetwork<float> plain{config, network.weights.tensors};
  planes::gcn::Graph graph;
  planes::gcn::make_graph(points, config, 1, simd, graph);
  const planes::gcn::Layers layers = planes::gcn::make_layers(network.weights);
  planes::gcn::Activations activations;
  const planes::Gcn whole(network.weights, simd);

  enum { kWhole, kForward, kPlain, kCount };
  const auto ms = interleaved_ms(
      kCount, rounds, [&] { turns.next(); },
      [&](std::size_t who, int) {
        if (who == kWhole) whole.forward(points, 1);
        if (who == kForward)
          planes::gcn::forward(graph, layers, planes::gcn::kernels(simd), 1, false, activations);
        if (who == kPlain) plain_forward(plain, plain_graph, points);
      });
  return {network.name,
          static_cast<int>(points.size()),
          median(ms[kWhole]),
          median(ms[kForward]),
          median(ms[kPlain]),
          median_ratio(ms[kPlain], ms[kWhole]),
          median_ratio(ms[kPlain], ms[kForward])};
}

}  // namespace

SpeedBench measure_speed(std::span<const BenchNetwork> networks,
                         const SpeedBenchOptions& options,
                         const std::function<void(int, int)>& progress) {
  std::vector<int> thread_counts = {1};
  if (options.threads > 1) thread_counts.push_back(options.threads);
  const std::size_t per_round =
      networks.size() * thread_counts.size() * (instruction_sets().size() + 2) + 3;
  Turns turns(static_cast<int>(std::size(kSizes) * per_round) * (options.rounds + 1), progress);

  SpeedBench bench;
  for (const int points : kSizes) {
    const std::vector<Points> clouds = make_clouds(points, options.seed);
    for (const BenchNetwork& network : networks)
      for (const int threads : thread_counts)
        bench.speed.push_back(race(network, clouds, options.rounds, threads, turns));
    bench.reference.push_back(race_reference(networks[0], clouds[0], options.rounds, turns));
  }
  return bench;
}

// ---- Whole frames ----

namespace {

constexpr int kWarmUp = 3;

planes::FrameResult load_and_run(const io::Recording& recording,
                                 int frame_number,
                                 const planes::PipelineOptions& options,
                                 const planes::Classifier& classifier) {
  const auto started = std::chrono::steady_clock::now();
  const Frame frame = recording.frame(frame_number);
  const std::chrono::duration<double, std::milli> load = std::chrono::steady_clock::now() - started;
  planes::FrameResult result = planes::run_frame(frame, options, &classifier);
  result.timings.load_ms = load.count();
  return result;
}

template <typename Value>
double median_of(const std::vector<FrameRow>& runs, const Value& value) {
  std::vector<double> values;
  for (const FrameRow& run : runs) values.push_back(value(run));
  return median(std::move(values));
}

}  // namespace

FrameRow measure_frames(const io::Recording& recording,
                        const std::vector<int>& frames,
                        const planes::PipelineOptions& options,
                        const planes::Classifier& classifier,
                        const std::function<void(int, int)>& progress,
                        int runs) {
  const std::size_t used = std::min(frames.size(), static_cast<std::size_t>(runs));
  std::vector<FrameRow> rows;
  for (int run = -kWarmUp; run < runs; ++run) {
    if (progress) progress(run + kWarmUp, runs + kWarmUp);
    const std::size_t nth = static_cast<std::size_t>(run + kWarmUp) % used;
    const planes::FrameResult result =
        load_and_run(recording, frames[nth * frames.size() / used], options, classifier);
    if (run < 0) continue;
    FrameRow& row = rows.emplace_back();
    row.points = static_cast<double>(result.cloud.points.size());
    row.voxels = static_cast<double>(result.voxels.points.size());
    row.planes = static_cast<double>(result.segmentation.planes.size());
    row.ms = result.timings;
  }

  FrameRow medians;
  medians.threads = options.threads;
  medians.frames = static_cast<int>(used);
  medians.runs = runs;
  for (double FrameRow::*value : {&FrameRow::points, &FrameRow::voxels, &FrameRow::planes})
    medians.*value = median_of(rows, [&](const FrameRow& run) { return run.*value; });
  for (double planes::FrameTimings::*stage :
       {&planes::FrameTimings::load_ms, &planes::FrameTimings::cloud_ms,
        &planes::FrameTimings::t_d_ms, &planes::FrameTimings::t_c_ms, &planes::FrameTimings::t_b_ms,
        &planes::FrameTimings::t_s_ms})
    medians.ms.*stage = median_of(rows, [&](const FrameRow& run) { return run.ms.*stage; });
  if (medians.voxels == 0) return medians;
  medians.fps =
      1000 / median_of(rows, [](const FrameRow& run) { return planes::paper_ms(run.ms); });
  medians.whole_fps = 1000 / median_of(rows, [](const FrameRow& run) {
                        return run.ms.cloud_ms + planes::paper_ms(run.ms);
                      });
  return medians;
}

}  // namespace planescope::lab
