// Sun et al. 2023, Sec. V.

#include "core/lab/experiments/printed.hpp"

namespace planescope::lab {

const std::vector<PrintedCell>& printed_cells() {
  static const std::vector<PrintedCell> cells = {
      {"I", "ours", true, 2048, 0, 0.03, 66, 25.2},
      {"I", "ours", true, 4096, 0, 0.01, 97, 2.08},
      {"I", "ours", true, 8192, 0, 0.00, 100, 0.00},
      {"I", "ours", false, 2048, 0, 9.17, 111, 6.81},
      {"I", "ours", false, 4096, 0, 8.02, 122, 0.05},
      {"I", "ours", false, 8192, 0, 12.18, 138, 0.00},
      {"III", "ours", true, 8192, 0.0, 0.00, 100, 0.00},
      {"III", "ours", true, 8192, 0.1, 0.10, 100, 0.00},
      {"III", "ours", true, 8192, 0.2, 0.26, 101, 0.00},
      {"III", "ours", true, 8192, 0.3, 1.36, 102, 0.08},
      {"III", "ours", false, 8192, 0.0, 12.18, 138, 0.00},
      {"III", "ours", false, 8192, 0.1, 12.62, 144, 0.00},
      {"III", "ours", false, 8192, 0.2, 13.63, 152, 0.00},
      {"III", "ours", false, 8192, 0.3, 14.98, 153, 0.04},
      {"V", "ransac", true, 8192, 0.05, 0.08, 100, 0.00},
      {"V", "ransac", true, 8192, 0.10, 0.11, 100, 0.04},
      {"V", "ransac", true, 8192, 0.15, 0.19, 100, 0.05},
      {"V", "ransac", true, 8192, 0.20, 0.21, 100, 0.07},
      {"V", "region-growing", true, 8192, 0.05, 0.28, 100, 0.72},
      {"V", "region-growing", true, 8192, 0.10, 0.29, 102, 0.75},
      {"V", "region-growing", true, 8192, 0.15, 0.34, 102, 0.77},
      {"V", "region-growing", true, 8192, 0.20, 0.38, 103, 0.82},
      {"V", "ours", true, 8192, 0.05, 0.04, 100, 0.00},
      {"V", "ours", true, 8192, 0.10, 0.10, 100, 0.00},
      {"V", "ours", true, 8192, 0.15, 0.17, 101, 0.00},
      {"V", "ours", true, 8192, 0.20, 0.26, 101, 0.00}};
  return cells;
}

const std::vector<PrintedClassifierTime>& printed_classifier_times() {
  static const std::vector<PrintedClassifierTime> times = {{2048, 6}, {4096, 10}, {8192, 23}};
  return times;
}

const std::vector<PrintedReal>& printed_real() {
  static const std::vector<PrintedReal> rows = {
      {"a: a stair", 105033, 5854, 3.0, 18.8, 1.4, 0.6, 42.0},
      {"b: grass with a vertical wall", 157418, 6653, 4.4, 20.7, 2.1, 0.5, 36.1},
      {"c: an indoor composite scene", 361516, 4197, 10.0, 13.9, 0.8, 0.5, 39.7}};
  return rows;
}

const std::vector<PrintedFps>& printed_fps() {
  static const std::vector<PrintedFps> speeds = {
      {"ransac", 3.1}, {"region-growing", 238.7}, {"ours", 35.3}};
  return speeds;
}

}  // namespace planescope::lab
