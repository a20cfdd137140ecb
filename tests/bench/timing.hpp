#pragma once

// Times of rounds that run rivals one after the other, so that both see the same machine.

#include <time.h>

namespace planescope {

/// Processor time of this thread: what other programs do does not count.
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

}  // namespace planescope
