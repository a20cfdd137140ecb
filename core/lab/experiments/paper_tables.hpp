#pragma once

// The paper's tables with ours beside the printed numbers, and the stricter ones.

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

/// A bar to be reached, and where it stands.
struct Claim {
  std::string set;                                           // "stairs of 8192 points, 0.1 cm"
  std::string measure;                                       // "alpha [deg]"
  std::string bar;                                           // "<= 0.04"
  double value = 0;                                          // with the printed seed
  double tuning = std::numeric_limits<double>::quiet_NaN();  // with the seed that was tuned on
  int frames = 0;                                            // that the value is the mean of
  bool met = false;                                          // with the printed one
  std::string others;  // as the paper and other methods have it
};

/// "Table I", ..., in the order of the page. What was not measured is left out of a table.
std::vector<Table> paper_tables(const PaperResults& results);
std::vector<Table> stricter_tables(const PaperResults& results);
std::vector<Table> timing_tables(const PaperTimings& timings);
std::vector<Claim> claims(const PaperResults& results);

Table claim_table(std::span<const Claim> claims);

}  // namespace planescope::lab
