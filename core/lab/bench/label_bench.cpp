#include "core/lab/bench/label_bench.hpp"

#include <array>

#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scan.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {

// ---- Labels ----

namespace {

enum Stream : std::uint64_t { kTiltAxis = 301, kTiltOfSet = 302 };

struct Set {
  const char* name;
  planes::LabelledCloud (*make)(std::uint64_t seed, int index);
};

planes::LabelledCloud stairs(double noise_m, std::uint64_t seed, int index) {
  return labelled(make_stairs(index, {.seed = seed, .noise_m = noise_m}));
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

planes::LabelAccuracy accuracy_on(const planes::LabelledCloud& cloud,
                                  const planes::Classifier& classifier) {
  return planes::label_accuracy(cloud, classifier.classify(cloud.points, 1).labels);
}

}  // namespace

planes::LabelledCloud tilted(const planes::LabelledCloud& cloud,
                             double angle_deg,
                             std::uint64_t seed) {
  const double azimuth_deg = 360 * random_uniform(seed, kTiltAxis, 0);
  const Mat3d turn = rotation({cos_deg(azimuth_deg), sin_deg(azimuth_deg), 0}, angle_deg);
  planes::LabelledCloud turned = cloud;
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
    const planes::LabelledCloud cloud =
        kSets[work / count].make(options.seed, static_cast<int>(work % count));
    const std::uint64_t tilt_seed = random_bits(options.seed, kTiltOfSet, work);
    const planes::LabelledCloud off = tilted(cloud, options.tilt_deg, tilt_seed);
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

// ---- The planes that follow ----

std::vector<ChainRow> measure_chain(std::span<const NamedClassifier> classifiers,
                                    const planes::SegmentOptions& segment,
                                    const LabelBenchOptions& options,
                                    const std::function<void(int, int)>& progress) {
  constexpr double kNoiseCm[] = {0, 0.1, 0.2, 0.3};
  planes::PipelineOptions pipeline;
  pipeline.segment = segment;
  pipeline.cloud.voxel_size_m = 0;

  const auto count = static_cast<std::size_t>(options.count), n = classifiers.size() + 1;
  // [noises][labels][stairs], so that those of a row lie side by side
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

}  // namespace planescope::lab
