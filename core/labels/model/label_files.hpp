#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/model/frame_labels.hpp"

namespace planescope::labels {

/// <recording>.labels beside the recording (a trailing slash is ignored).
std::filesystem::path default_label_dir(const std::filesystem::path& recording);

/// DIR/000123.{plane.png,hv.png,json}, numbered by 0-based depth frame.
void write_frame_labels(const std::filesystem::path& dir,
                        int frame_index,
                        const FrameLabels& labels);
/// nullopt if the frame has no labels there. Throws Error if files are damaged, or if
/// `expected_sha256` is not empty and differs, or sizes differ: labels are refused, never resized.
std::optional<FrameLabels> read_frame_labels(const std::filesystem::path& dir,
                                             int frame_index,
                                             const std::string& expected_sha256);

}  // namespace planescope::labels
