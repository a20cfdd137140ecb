#include "core/lab/experiments/measure_timings.hpp"

#include <set>

#include "core/lab/bench/interleaved.hpp"
#include "core/lab/bench/statistics.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {
namespace {

constexpr double kNoiseCm = 0.1;

std::vector<EvaluationFrame> stairs(const TimingOptions& options, int points, double noise_cm) {
  std::vector<EvaluationFrame> frames;
  for (int i = 0; i < options.rounds; ++i) {
    frames.push_back(cell_frame(stairs_of(options.seed, points, noise_cm), i, {}));
    if (options.before_turn) options.before_turn();
  }
  return frames;
}

std::function<void()> before(const TimingOptions& options) {
  return options.before_turn ? options.before_turn : [] {};
}

}  // namespace

std::vector<ClassifierTiming> classifier_timings(const CellTools& tools,
                                                 const TimingOptions& options) {
  struct Contestant {
    const char* name;
    const planes::Classifier& classifier;
    int threads;
  };
  std::vector<Contestant> contestants;
  for (const int threads : std::set<int>{1, options.threads}) {
    contestants.push_back({"gcn", *tools.gcn, threads});
    contestants.push_back({"pca", *tools.pca, threads});
  }
  std::vector<ClassifierTiming> timings;
  for (const int points : {2048, 4096, 8192}) {
    const std::vector<EvaluationFrame> frames = stairs(options, points, 0);
    const auto ms = interleaved_ms(
        contestants.size(), options.rounds, before(options), [&](std::size_t c, int round) {
          const EvaluationFrame& frame = frames[static_cast<std::size_t>(round)];
          contestants[c].classifier.classify(frame.frame.cloud->points, contestants[c].threads);
        });
    for (std::size_t c = 0; c < contestants.size(); ++c)
      timings.push_back({contestants[c].name, points, contestants[c].threads, median(ms[c])});
  }
  return timings;
}

std::vector<MethodTiming> method_timings(const CellTools& tools, const TimingOptions& options) {
  const CellKey frames_key = stairs_of(options.seed, 8192, kNoiseCm);
  std::vector<MethodTiming> timings;
  for (const char* profile : {"paper", "refined"})
    for (const char* labels : {"gcn", "pca"})
      timings.push_back({with_ours(frames_key, profile, labels), 0});
  for (const planes::Method method : planes::built_methods())
    if (method != planes::Method::ours && method != planes::Method::pcl_multi_plane)
      timings.push_back({with_rival(frames_key, planes::to_string(method)), 0});

  std::vector<planes::PipelineOptions> pipelines;
  for (const MethodTiming& timing : timings) pipelines.push_back(cell_options(timing.key));
  const std::vector<EvaluationFrame> frames = stairs(options, 8192, kNoiseCm);
  const auto ms = interleaved_ms(
      timings.size(), options.rounds, before(options), [&](std::size_t c, int round) {
        const std::string& labels = timings[c].key.classifier;
        const planes::Classifier* classifier = labels == "gcn"   ? tools.gcn.get()
                                               : labels == "pca" ? tools.pca.get()
                                                                 : nullptr;
        planes::run_frame(frames[static_cast<std::size_t>(round)].frame, pipelines[c], classifier);
      });
  for (std::size_t c = 0; c < timings.size(); ++c) timings[c].fps = 1000 / median(ms[c]);
  return timings;
}

}  // namespace planescope::lab
