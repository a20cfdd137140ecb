#pragma once

// What the paper prints: tables I to V of its Experiments section.

#include <string>
#include <vector>

namespace planescope::lab {

/// Means over all 100 stairs.
struct PrintedCell {
  std::string table;        // "I", "III", "V"
  std::string method;       // "ours", "ransac", "region-growing"
  bool with_labels = true;  // false: "w/o PC"
  int points = 8192;
  double noise_cm = 0;
  double alpha_deg = 0, r_p = 0, r_m = 0;
};
const std::vector<PrintedCell>& printed_cells();

struct PrintedClassifierTime {
  int points = 0;
  double ms = 0;
};
const std::vector<PrintedClassifierTime>& printed_classifier_times();  // table II

struct PrintedReal {
  std::string scene;
  int n_m = 0, n_d = 0;
  double t_d_ms = 0, t_c_ms = 0, t_b_ms = 0, t_s_ms = 0, fps = 0;
};
const std::vector<PrintedReal>& printed_real();  // table IV

struct PrintedFps {
  std::string method;
  double fps = 0;
};
const std::vector<PrintedFps>& printed_fps();  // the text beside table V

}  // namespace planescope::lab
