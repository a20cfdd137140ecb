#pragma once

// Writes a run as plain text, for reference and for line-by-line comparison of versions or settings
// on one frame.

#include <string>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// Contains every event, in words and numbers; the changes of every plane, point and node; the
/// matches of a fixed list of filters; and the explanations of nodes, merges, leftover points and
/// positions (evenly sampled if there are many). With `pinned`, a run of the same frame, also the
/// differences between both. Plane and node values are printed with all digits.
std::string trace_text(const Run& run, const Run* pinned = nullptr);

}  // namespace planescope::debug
