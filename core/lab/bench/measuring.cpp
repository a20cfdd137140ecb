// Machine facts, clocks, interleaved timing and medians for benchmarks.

#include "core/lab/bench/measuring.hpp"

#include <time.h>

#include <algorithm>
#include <cassert>
#include <fstream>
#include <thread>

namespace planescope::lab {

Machine this_machine() {
  Machine machine;
  machine.cpu = "unknown";
  machine.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  machine.simd = best_simd();
  std::ifstream facts("/proc/cpuinfo");
  for (std::string line; std::getline(facts, line);)
    if (line.starts_with("model name"))
      if (const std::size_t colon = line.find(": "); colon != std::string::npos) {
        machine.cpu = line.substr(colon + 2);
        break;
      }
  return machine;
}

ResidentMemory resident_memory(const std::string& status_file) {
  ResidentMemory memory;
  std::ifstream status(status_file);
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) memory.now_mib = std::stod(line.substr(6)) / 1024;  // from kB
    if (line.starts_with("VmHWM:")) memory.peak_mib = std::stod(line.substr(6)) / 1024;
  }
  return memory;
}

namespace {

double now_ms(Clock clock) {
  clockid_t id = CLOCK_MONOTONIC;
  if (clock == Clock::thread_cpu) id = CLOCK_THREAD_CPUTIME_ID;
  if (clock == Clock::process_cpu) id = CLOCK_PROCESS_CPUTIME_ID;
  timespec time{};
  clock_gettime(id, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

}  // namespace

const char* to_string(Clock clock) {
  switch (clock) {
    case Clock::thread_cpu:
      return "CPU time of the thread";
    case Clock::process_cpu:
      return "CPU time of the process";
    case Clock::wall:
      break;
  }
  return "wall clock";
}

double spent_ms(Clock clock, const std::function<void()>& work) {
  const double begin = now_ms(clock);
  work();
  return now_ms(clock) - begin;
}

std::vector<std::vector<double>> interleaved_ms(std::size_t contestants,
                                                int rounds,
                                                const std::function<void()>& before,
                                                const std::function<void(std::size_t, int)>& body,
                                                Clock clock) {
  std::vector<std::vector<double>> spent(contestants);
  for (int round = -1; round < rounds; ++round) {
    const int number = round + 1;
    for (std::size_t turn = 0; turn < contestants; ++turn) {
      const std::size_t contestant = (static_cast<std::size_t>(number) + turn) % contestants;
      before();
      const double taken = spent_ms(clock, [&] { body(contestant, std::max(round, 0)); });
      if (round >= 0) spent[contestant].push_back(taken);
    }
  }
  return spent;
}

double median(std::vector<double> values) {
  assert(!values.empty());
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

Times times_of(const std::vector<double>& values) {
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  return {median(values), *least, *greatest};
}

double median_ratio(std::span<const double> numerators, std::span<const double> denominators) {
  assert(numerators.size() == denominators.size());
  std::vector<double> ratios;
  for (std::size_t i = 0; i < numerators.size(); ++i)
    ratios.push_back(numerators[i] / denominators[i]);
  return median(std::move(ratios));
}

}  // namespace planescope::lab
