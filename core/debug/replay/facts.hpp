#pragma once

#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// Run::facts of a run whose segmentation is there. Internal to core/debug/replay.
std::vector<NodeFacts> facts_of(const Run& run);

}  // namespace planescope::debug
