#pragma once

// All that is known of a run, as plain text: to look things up in, and to compare line by line what
// two versions, or two settings, make of one frame.

#include <string>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// Every event in words and numbers; the changes of every plane, point and node; which events a
/// fixed list of filters finds; and what core/debug/explain answers about nodes, merges, leftover
/// points and places, of each kind evenly strided where there are many. With `pinned`, a run of the
/// same frame: where the two part. Numbers of planes and nodes have all their digits.
std::string trace_text(const Run& run, const Run* pinned = nullptr);

}  // namespace planescope::debug
