#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"

namespace planescope::app {

/// "tables", "timings", "figures".
const std::vector<std::string>& bench_paper_parts();

/// A real recording under the name that it has in tables.
struct PaperRecording {
  std::string name;
  InputArgs input;
};

struct BenchPaperArgs {
  std::vector<PaperRecording> recordings;
  std::filesystem::path data;   // folder of recordings that labels are taken from
  std::string weights = "gcn";  // gcn, the shipped ones, or a file
  std::set<std::string> parts;  // of bench_paper_parts()
  std::uint64_t seed = 1, tuning_seed = 1001;
  std::vector<std::string> sets;  // that are measured; empty: all
  int count = 0;                  // frames of a set at most; 0: all
  bool quick = false;             // fewer frames and conditions
  bool resume = false;
  int threads = 1;
  std::filesystem::path out;   // -o
  std::filesystem::path from;  // results that are there: nothing is measured
  std::filesystem::path doc;   // with `from`: the file of docs/reproduction.md
  bool json = false;
  std::string same_command;  // measures the same again; without folders, which are this machine's
};

/// The paper's experiments: paper.json, .md and index.html, and what depends on time in
/// paper.timings.json and .md. Returns the exit code, 3 where pictures could not be drawn; throws
/// Cancelled on stop, and what was measured can be gone on with.
int run_bench_paper(const BenchPaperArgs& args, std::stop_token stop);

}  // namespace planescope::app
