#include "core/lab/bench/chain_bench.hpp"

#include "core/lab/synthetic/stairs.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/pipeline/score.hpp"

namespace planescope::lab {

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
