#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/lab/experiments/measure_real.hpp"

namespace planescope::app {

/// The frames of a list like tests/real/labels/list.txt, of one half or of both: lines of
/// NAME HALF RECORDING FRAME OPTIONS. Throws Error naming the list and the line that is not
/// understood, and where no frame is left.
std::vector<lab::ListedFrame> labelled_list(const std::filesystem::path& list,
                                            std::optional<lab::Half> half = {});

}  // namespace planescope::app
