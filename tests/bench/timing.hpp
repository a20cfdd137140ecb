#pragma once

// For rounds that run rivals one after the other, so that both see the same machine. Takes the
// processor time of this thread, so that others' work does not count.

#include <time.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace planescope {

inline double thread_time_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

double milliseconds(const auto& work) {
  const double begin = thread_time_ms();
  work();
  return thread_time_ms() - begin;
}

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace planescope
