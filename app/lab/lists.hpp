#pragma once

// Lists of recordings: lines of words, with options as they would be typed.

#include <filesystem>
#include <optional>
#include <vector>

#include "app/lab/bench_paper.hpp"
#include "core/lab/experiments/measure_real.hpp"

namespace planescope::app {

/// The frames of a list like tests/real/labels/list.txt, of one half or of both: lines of
/// NAME HALF RECORDING FRAME OPTIONS. Throws Error naming the list and the line that is not
/// understood, and where no frame is left.
std::vector<lab::ListedFrame> labelled_list(const std::filesystem::path& list,
                                            std::optional<lab::Half> half = {});

/// Of a list like assets/paper_recordings.txt those that are there below `data`. Throws Error
/// naming the list and the line that is not understood.
std::vector<PaperRecording> listed_recordings(const std::filesystem::path& list,
                                              const std::filesystem::path& data);

}  // namespace planescope::app
