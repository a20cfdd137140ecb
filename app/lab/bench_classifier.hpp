#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"

namespace planescope::app {

/// "accuracy", "gravity", "chain", "speed", "frames".
const std::vector<std::string>& bench_classifier_parts();

struct BenchClassifierArgs {
  InputArgs input;                             // recordings whose frames are timed; the options
  std::vector<std::string> weights = {"gcn"};  // gcn, the shipped ones, or files
  std::set<std::string> parts;                 // of bench_classifier_parts()
  std::uint64_t seed = 960001;                 // of the clouds: no training has it
  int count = 100;                             // clouds of each kind
  int rounds = 20;                             // of the speed part
  std::filesystem::path out;                   // -o; empty: nothing is written
  bool json = false;
  std::string command;  // as it was typed
};

/// Measures networks: prints tables, and writes classifier.json and .md, and what depends on time
/// to classifier.timings.json and .md. Returns the exit code; throws Cancelled on stop.
int run_bench_classifier(const BenchClassifierArgs& args, std::stop_token stop);

}  // namespace planescope::app
