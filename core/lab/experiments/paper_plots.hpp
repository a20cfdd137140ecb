#pragma once

// What the cells say at a glance. Included by paper_page.cpp and its test only.

#include <string>
#include <vector>

#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

struct PaperPlot {
  std::string title;
  std::string note;
  std::string svg;
};

/// Measures against noise on the stairs of 8192 points, ours beside the printed curve and the
/// rivals.
std::vector<PaperPlot> noise_plots(const PaperResults& results);
/// Mean IoU of every method on every set, clouds and depth images.
std::vector<PaperPlot> set_plots(const PaperResults& results);

}  // namespace planescope::lab
