#pragma once

#include <filesystem>
#include <vector>

#include "app/lab/bench_paper.hpp"

namespace planescope::app {

/// Of a list like assets/paper_recordings.txt those that are there below `data`. Throws Error
/// naming the list and the line that is not understood.
std::vector<PaperRecording> listed_recordings(const std::filesystem::path& list,
                                              const std::filesystem::path& data);

}  // namespace planescope::app
