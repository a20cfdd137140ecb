#pragma once

// docs/reproduction.md: what the paper prints, what its text gives, and what we reach. Every figure
// of it comes from a run.

#include <string>

#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

std::string reproduction_page(const PaperResults& results, const PaperTimings& timings);

}  // namespace planescope::lab
