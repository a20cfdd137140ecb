#pragma once

// The pictures of `planescope bench paper`.

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "app/lab/bench_paper.hpp"
#include "core/lab/experiments/paper_page.hpp"
#include "render/renderer.hpp"

namespace planescope::app {

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
