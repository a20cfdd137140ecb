#include "core/lab/bench/measuring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
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

std::string to_text(const Machine& machine) {
  return fmt::format("{}, {} cores, {}", machine.cpu, machine.cores, to_string(machine.simd));
}

std::vector<std::vector<double>> interleaved_ms(std::size_t contestants,
                                                int rounds,
                                                const std::function<void()>& before,
                                                const std::function<void(std::size_t, int)>& body) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<double>> spent(contestants);
  for (int round = -1; round < rounds; ++round) {
    const int number = round + 1;
    for (std::size_t turn = 0; turn < contestants; ++turn) {
      const std::size_t contestant = (static_cast<std::size_t>(number) + turn) % contestants;
      before();
      const auto started = Clock::now();
      body(contestant, std::max(round, 0));
      const std::chrono::duration<double, std::milli> taken = Clock::now() - started;
      if (round >= 0) spent[contestant].push_back(taken.count());
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

double median_ratio(std::span<const double> numerators, std::span<const double> denominators) {
  assert(numerators.size() == denominators.size());
  std::vector<double> ratios;
  for (std::size_t i = 0; i < numerators.size(); ++i)
    ratios.push_back(numerators[i] / denominators[i]);
  return median(std::move(ratios));
}

MeanAndDeviation mean_and_deviation(std::span<const double> values) {
  MeanAndDeviation result;
  if (values.empty()) return result;
  const auto count = static_cast<double>(values.size());
  for (const double value : values) result.mean += value / count;
  if (values.size() < 2) return result;
  double squares = 0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.deviation = std::sqrt(squares / (count - 1));
  return result;
}

}  // namespace planescope::lab
