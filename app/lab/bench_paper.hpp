#pragma once

// What the files of `planescope-lab bench paper` share: the real recordings of table IV, and
// pictures.

#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "core/lab/experiments/paper_page.hpp"
#include "core/lab/experiments/results.hpp"
#include "render/renderer.hpp"

namespace planescope::app {

/// A real recording under the name that it has in tables.
struct PaperRecording {
  std::string name;
  InputArgs input;
};

struct RealInput {
  std::string name;
  OpenInput input;
  planes::PipelineOptions options;  // of one thread
};
/// Opens all, and takes at most `frames` of each, evenly spread.
std::vector<RealInput> open_real(std::span<const PaperRecording> recordings, int frames);

/// The same for any number of threads. Throws Error where a frame cannot be read. `progress(done,
/// all)` may throw to stop.
lab::RealRow measure_real(const RealInput& real,
                          const planes::Classifier& classifier,
                          int threads,
                          const std::function<void(int, int)>& progress = {});
/// Of the frames whose gravity is known, `runs` runs.
lab::RealTiming time_real(const RealInput& real,
                          const planes::Classifier& classifier,
                          int threads,
                          int runs,
                          const std::function<void(int, int)>& progress = {});

struct PaperFigureArgs {
  std::vector<PaperRecording> recordings;
  std::string weights = "gcn";  // gcn, the shipped ones, or a file
  int threads = 1;
  std::stop_token stop;
  std::function<void(const std::string& what)> progress;  // before each picture; may be empty
};

/// All figures, those without pictures left out. Seeds are those of `results`, labels those of the
/// network. The same pixels for any thread count. Throws Error where weights are missing,
/// a recording is damaged or nothing can be drawn, Cancelled on stop.
std::vector<lab::PaperFigure> draw_paper_figures(const PaperFigureArgs& args,
                                                 const lab::PaperResults& results,
                                                 render::Renderer& renderer);

}  // namespace planescope::app
