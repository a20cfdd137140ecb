#pragma once

// How the quantities of the criteria spread over all nodes, with the threshold in force.

#include <cstdint>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

struct HistogramBin {
  double low = 0, high = 0;
  std::uint32_t right = 0, wrong = 0;  // wrong: the decision disagrees with ground truth
  std::uint32_t unknown = 0;           // no ground truth
};

struct Histogram {
  std::string quantity;  // "n_out", as the filter language calls it; empty where it does not
  std::string title;     // "N_out"
  std::string unit;
  std::string option;    // whose value is the threshold; empty: none to drag
  double threshold = 0;  // NaN where there is none or it varies from place to place
  bool logarithmic = false;
  std::vector<HistogramBin> bins = {};
};

/// N_out, r_out, N_in, e_n over the nodes where the criterion was asked, and the terms of merges;
/// of a depth image its own Criteria 1-3, the costs of joins and the worth of planes that are not
/// listed.
std::vector<Histogram> histograms_of(const Run& run);

}  // namespace planescope::debug
