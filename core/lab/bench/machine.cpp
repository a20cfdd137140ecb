#include "core/lab/bench/machine.hpp"

#include <algorithm>
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

}  // namespace planescope::lab
