#include "core/lab/bench/label_bench.hpp"

#include <array>

#include "core/lab/synthetic/counter_random.hpp"
#include "core/lab/synthetic/rotation.hpp"
#include "core/lab/synthetic/scan.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/model/parallel.hpp"

namespace planescope::lab {
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

}  // namespace planescope::lab
