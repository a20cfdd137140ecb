#pragma once

#include <string>
#include <vector>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/real_results.hpp"

namespace planescope::lab {

/// Halves, frames, sets, neighbouring frames: of what was measured.
std::vector<Table> real_tables(const RealResults& results);

/// real.md.
std::string real_markdown(const RealResults& results);

}  // namespace planescope::lab
