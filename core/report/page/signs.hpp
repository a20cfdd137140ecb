#pragma once

// Signs that planes of a frame went wrong, told without labels and without a baseline: which frames
// to look at first where nothing else says so.

#include <string>

#include "core/report/data/report_data.hpp"

namespace planescope::report {

struct Signs {
  int slivers = 0;        // planes too narrow for a circle of 4 cm radius
  int floor_pieces = 0;   // level planes within 3 cm of the floor's height: pieces of it, beside it
  int low_support = 0;    // planes that miss a tenth of the pixels within their outline
  double off_planes = 0;  // share of the points, 0 to 1

  /// The more, the worse: a floor in pieces counts three times a sliver, low support twice, and all
  /// points off planes once.
  double weight() const;
  /// "2 slivers, the floor in 3 pieces, 1 plane of low support; 61.2 % of the points on planes".
  std::string text() const;
};

/// Of a frame that was processed.
Signs signs_of(const ReportFrame& frame);

}  // namespace planescope::report
