#pragma once

// Samples into bins with round edges. Internal to core/explain.

#include <vector>

#include "core/explain/histogram.hpp"

namespace planescope {

enum class Judgement : std::uint8_t { right, wrong, unknown };  // against ground truth

struct Sample {
  double value = 0;
  Judgement judgement = Judgement::unknown;
};

/// Linear bins of a round width, about 24, from 0 on where the values come near it; what is beyond
/// `most` is in the last one.
std::vector<HistogramBin> linear_bins(const std::vector<Sample>& samples, double most, bool whole);
/// Edges 1, 2, 5, 10 ... over the upper eight decades; what is below is in the first one.
std::vector<HistogramBin> logarithmic_bins(const std::vector<Sample>& samples);

}  // namespace planescope
