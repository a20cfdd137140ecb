#pragma once

// The experiments as Markdown. Every figure comes from a run.

#include <string>

#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

/// paper.md: claims, the paper's tables, the stricter ones.
std::string paper_markdown(const PaperResults& results);

/// docs/reproduction.md: what the paper prints, what its text gives, and what we reach.
std::string reproduction_page(const PaperResults& results, const PaperTimings& timings);

}  // namespace planescope::lab
