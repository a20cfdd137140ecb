#pragma once

// The experiments as one HTML page that needs nothing beside it.

#include <span>
#include <string>
#include <vector>

#include "core/lab/bench/results_page.hpp"
#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

struct PaperPicture {
  std::string column;                // heading within its figure: "noise 0.3 cm", "RANSAC 0.02"
  std::string row;                   // "with PC"
  std::string caption;               // "10 planes found, 10 true"
  std::string png;                   // file name beside the page
  std::vector<unsigned char> bytes;  // of the PNG
  std::vector<unsigned char> copy;   // smaller, WebP, for the page
  int width = 0, height = 0;         // of the PNG [px]
};
struct PaperFigure {
  std::string id;  // "stairs_noise", "real_scenes", "node_cases", "stages", "failures"
  std::string title;
  std::string note;                    // what it shows, and the command that shows it again
  std::vector<PaperPicture> pictures;  // at most one for each row and column, in any order
};

/// Tables, plots (SVG) and pictures. `timings` may be null.
std::string paper_page(const PaperResults& results,
                       const PaperTimings* timings,
                       std::span<const PaperFigure> figures);

/// Measures against noise on the stairs of 8192 points, ours beside the printed curve and the
/// rivals.
std::vector<Plot> noise_plots(const PaperResults& results);
/// Mean IoU of every method on every set, clouds and depth images.
std::vector<Plot> set_plots(const PaperResults& results);

}  // namespace planescope::lab
