#pragma once

#include <string>
#include <vector>

#include "tests/real/frame_output.hpp"

namespace planescope {

/// When two planes count as one surface that was split into parallel sheets.
struct SheetOptions {
  double max_angle_deg = 5;
  double max_offset_m = 0.06;  // of one plane's centroid from the other plane
  double cell_m = 0.05;        // overlap is counted in cells of this size
  double min_overlap = 0.2;    // share of the smaller plane's cells that the other covers too
  int min_points = 300;        // smaller planes are crumbs, not sheets
};

/// One line per pair of planes with the same label that lie over each other, nearly parallel and
/// close.
std::vector<std::string> find_sheets(const FrameOutput& output, const SheetOptions& options);

}  // namespace planescope
