#pragma once

// How the laboratory measures times: on what machine, in turns, by medians.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/model/simd.hpp"

namespace planescope::lab {

/// What timings were measured on.
struct Machine {
  std::string cpu;  // as the kernel names it, "unknown" where it does not
  int cores = 1;    // that the program may use
  Simd simd = Simd::plain;
};
Machine this_machine();
std::string to_text(const Machine& machine);  // "AMD EPYC 7763, 16 cores, avx2"

/// Wall-clock milliseconds of every contestant, [contestants][rounds]. In each round each of them
/// runs once, so that all share what the machine was busy with; who begins changes from round to
/// round, and a first round is not counted. `before()` is called before each turn and not counted;
/// `body(contestant, round)`.
std::vector<std::vector<double>> interleaved_ms(std::size_t contestants,
                                                int rounds,
                                                const std::function<void()>& before,
                                                const std::function<void(std::size_t, int)>& body);

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
