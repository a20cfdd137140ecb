#include "core/lab/bench/frame_bench.hpp"

#include <chrono>

#include "core/lab/bench/measuring.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {
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
