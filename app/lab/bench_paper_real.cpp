#include <algorithm>
#include <optional>

#include "app/lab/bench_paper.hpp"
#include "core/lab/bench/frame_bench.hpp"
#include "core/model/parallel.hpp"

namespace planescope::app {

std::vector<RealInput> open_real(std::span<const PaperRecording> recordings, int frames) {
  std::vector<RealInput> opened;
  for (const PaperRecording& recording : recordings) {
    RealInput real{recording.name, std::move(open_inputs(recording.input)[0]),
                   recording.input.pipeline};
    real.options.threads = 1;
    const std::vector<int> all = std::move(real.input.frames);
    const std::size_t used = std::min(all.size(), static_cast<std::size_t>(frames));
    real.input.frames.clear();
    for (std::size_t i = 0; i < used; ++i) real.input.frames.push_back(all[i * all.size() / used]);
    opened.push_back(std::move(real));
  }
  return opened;
}

lab::RealRow measure_real(const RealInput& real,
                          const planes::Classifier& classifier,
                          int threads,
                          const std::function<void(int, int)>& progress) {
  struct Sizes {
    double n_m = 0, n_d = 0, planes = 0;
  };
  std::vector<std::optional<Sizes>> of_frames(real.input.frames.size());
  const auto measure = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    try {
      const LoadedFrame loaded =
          run_input_frame(real.input, real.input.frames[k], real.options, &classifier, false);
      const planes::FrameResult& result = loaded.result;
      of_frames[k] = {static_cast<double>(result.cloud.counts.kept),
                      static_cast<double>(result.voxels.points.size()),
                      static_cast<double>(result.segmentation.planes.size())};
    } catch (const FrameRefused&) {
      // Counted below: nothing tells which way is down there.
    }
  };
  work_through(static_cast<int>(of_frames.size()), threads, measure, progress);

  lab::RealRow row;
  row.recording = real.name;
  for (const std::optional<Sizes>& sizes : of_frames) {
    if (!sizes) {
      ++row.refused;
      continue;
    }
    ++row.frames;
    row.n_m += sizes->n_m;
    row.n_d += sizes->n_d;
    row.planes += sizes->planes;
  }
  if (row.frames > 0)
    for (double* sum : {&row.n_m, &row.n_d, &row.planes}) *sum /= row.frames;
  return row;
}

lab::RealTiming time_real(const RealInput& real,
                          const planes::Classifier& classifier,
                          int threads,
                          int runs,
                          const std::function<void(int, int)>& progress) {
  lab::RealTiming timing;
  timing.recording = real.name;
  planes::PipelineOptions options = real.options;
  std::vector<int> frames;
  for (const int frame : real.input.frames) {
    try {
      planes::resolve_gravity(real.input.recording->frame(frame), options.gravity);
      frames.push_back(frame);
    } catch (const Error&) {
      // Refused, as table IV's sizes say.
    }
  }
  timing.frames = static_cast<int>(frames.size());
  if (frames.empty()) return timing;
  options.threads = threads;
  const lab::FrameRow row =
      lab::measure_frames(*real.input.recording, frames, options, classifier, progress, runs);
  timing.t_d_ms = row.ms.t_d_ms;
  timing.t_c_ms = row.ms.t_c_ms;
  timing.t_b_ms = row.ms.t_b_ms;
  timing.t_s_ms = row.ms.t_s_ms;
  timing.fps = row.fps;
  return timing;
}

}  // namespace planescope::app
