#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "core/lab/experiments/measure_real.hpp"

namespace planescope::app {

/// "frames", "sets", "repeat".
const std::vector<std::string>& bench_real_parts();

struct BenchRealArgs {
  std::set<std::string> parts;           // of bench_real_parts()
  std::vector<lab::ListedFrame> frames;  // of part frames
  std::filesystem::path data;            // folder of the recordings; of parts frames and repeat
  std::filesystem::path labels;          // folder of the labels' folders; of part frames
  std::vector<std::uint64_t> seeds;      // of part sets
  int count = 0;  // frames of a set and of repeat's recording at most; 0: all
  int threads = 1;
  std::filesystem::path out;  // -o
  bool json = false;
  std::string same_command;  // measures the same again; without folders, which are this machine's
};

/// Every method by pixel: on labelled frames, on depth sets of many seeds, from frame to frame.
/// Writes real.json and real.md, prints the tables, and returns 0; throws Cancelled on stop.
int run_bench_real(const BenchRealArgs& args, std::stop_token stop);

}  // namespace planescope::app
