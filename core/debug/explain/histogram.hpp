#pragma once

// Distributions of the criteria's values over all nodes, with their thresholds.

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
  std::string quantity;  // name in the filter language, "n_out"; empty if none
  std::string title;     // "N_out"
  std::string unit;
  std::string option;    // option that sets the threshold; empty: none to drag
  double threshold = 0;  // NaN if there is none or it varies between nodes
  bool logarithmic = false;
  std::vector<HistogramBin> bins = {};
};

/// N_out, r_out, N_in and e_n over the nodes where the criterion was evaluated, and the terms
/// of merges. For depth images: their own Criteria 1-3, the costs of joins and the worth of
/// dropped planes.
std::vector<Histogram> histograms_of(const Run& run);

}  // namespace planescope::debug
