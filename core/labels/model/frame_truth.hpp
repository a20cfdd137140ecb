#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/planes/pipeline/truth.hpp"

namespace planescope::labels {

/// From `label_dir` where that holds labels of the frame (`sha256` must match where it is not
/// empty), otherwise from the frame's own cloud fields, otherwise nullopt.
std::optional<planes::SourceTruth> frame_truth(const Frame& frame,
                                               const std::filesystem::path& label_dir,
                                               const std::string& sha256);

}  // namespace planescope::labels
