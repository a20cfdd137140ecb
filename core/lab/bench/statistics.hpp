#pragma once

#include <span>
#include <vector>

namespace planescope::lab {

/// The middle value, the mean of the middle two where the count is even. At least one value.
double median(std::vector<double> values);

/// The median of numerators[i] / denominators[i]: of values that were measured side by side, so
/// that what slowed one down slowed the other.
double median_ratio(std::span<const double> numerators, std::span<const double> denominators);

struct MeanAndDeviation {
  double mean = 0;
  double deviation = 0;  // standard deviation of a sample; 0 for less than two values
};
MeanAndDeviation mean_and_deviation(std::span<const double> values);

}  // namespace planescope::lab
