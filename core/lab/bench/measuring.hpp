#pragma once

// Timing in the laboratory: the machine, interleaved runs, and medians.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/model/json_fields.hpp"
#include "core/model/parallel.hpp"

namespace planescope::lab {

/// The machine of the timings.
struct Machine {
  std::string cpu;  // from the kernel, "unknown" if missing
  int cores = 1;    // available to the program
  Simd simd = Simd::plain;
};
Machine this_machine();

/// A process's resident memory; zeros if its status file (/proc/self/status) lacks it.
struct ResidentMemory {
  double now_mib = 0, peak_mib = 0;
};
ResidentMemory resident_memory(const std::string& status_file);

/// Type of time. CPU time hardly depends on the machine's other load; wall time is the time that
/// users wait, and that threads shorten.
enum class Clock { wall, thread_cpu, process_cpu };
const char* to_string(Clock clock);  // "wall clock", "CPU time of the thread", ...

/// Milliseconds of `work` on that clock.
double spent_ms(Clock clock, const std::function<void()>& work);
inline double thread_ms(const std::function<void()>& work) {
  return spent_ms(Clock::thread_cpu, work);
}

/// Milliseconds of every contestant, [contestants][rounds]. Each contestant runs once per round, so
/// that all are affected by the same load. The first contestant changes from round to round, and a
/// warm-up round is not counted. `before()` is called before each turn and not counted;
/// `body(contestant, round)`.
std::vector<std::vector<double>> interleaved_ms(std::size_t contestants,
                                                int rounds,
                                                const std::function<void()>& before,
                                                const std::function<void(std::size_t, int)>& body,
                                                Clock clock = Clock::wall);

/// The middle value, or the mean of the middle two for an even count. At least one value.
double median(std::vector<double> values);

/// Summary of repeated runs [ms].
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

/// The median of numerators[i] / denominators[i], for values measured side by side, so that both
/// were slowed down equally.
double median_ratio(std::span<const double> numerators, std::span<const double> denominators);

}  // namespace planescope::lab
