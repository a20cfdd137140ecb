#pragma once

#include <span>
#include <vector>

namespace planescope {

/// The middle value, the mean of the middle two where the count is even. At least one value.
double median(std::vector<double> values);

/// The median of numerators[i] / denominators[i]: of values that were measured side by side, so
/// that what slowed one down slowed the other.
double median_ratio(std::span<const double> numerators, std::span<const double> denominators);

}  // namespace planescope
