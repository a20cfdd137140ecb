#pragma once

// How the laboratory measures times: on what machine, in turns, by medians.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/model/json_fields.hpp"
#include "core/model/parallel.hpp"

namespace planescope::lab {

/// What timings were measured on.
struct Machine {
  std::string cpu;  // as the kernel names it, "unknown" where it does not
  int cores = 1;    // that the program may use
  Simd simd = Simd::plain;
};
Machine this_machine();

/// What a process has resident; zeros where its status file (/proc/self/status) does not tell.
struct ResidentMemory {
  double now_mib = 0, peak_mib = 0;
};
ResidentMemory resident_memory(const std::string& status_file);

/// Which time counts. CPU time is hardly touched by what else the machine is busy with; the wall's
/// is what a user waits for, and what threads shorten.
enum class Clock { wall, thread_cpu, process_cpu };
const char* to_string(Clock clock);  // "wall clock", "CPU time of the thread", ...

/// Milliseconds of `work` on that clock.
double spent_ms(Clock clock, const std::function<void()>& work);
inline double thread_ms(const std::function<void()>& work) {
  return spent_ms(Clock::thread_cpu, work);
}

/// Milliseconds of every contestant, [contestants][rounds]. In each round each of them runs once,
/// so that all share what the machine was busy with; who begins changes from round to round, and a
/// first round is not counted. `before()` is called before each turn and not counted;
/// `body(contestant, round)`.
std::vector<std::vector<double>> interleaved_ms(std::size_t contestants,
                                                int rounds,
                                                const std::function<void()>& before,
                                                const std::function<void(std::size_t, int)>& body,
                                                Clock clock = Clock::wall);

/// The middle value, the mean of the middle two where the count is even. At least one value.
double median(std::vector<double> values);

/// What is printed of several runs of one thing [ms].
struct Times {
  double median = 0, least = 0, greatest = 0;
};
void visit_fields(auto& fields, Same<Times> auto& times) {
  fields("median", times.median);
  fields("least", times.least);
  fields("greatest", times.greatest);
}
/// At least one value.
Times times_of(const std::vector<double>& values);

/// The median of numerators[i] / denominators[i]: of values that were measured side by side, so
/// that what slowed one down slowed the other.
double median_ratio(std::span<const double> numerators, std::span<const double> denominators);

}  // namespace planescope::lab
