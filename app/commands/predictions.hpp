#pragma once

// Segmentations that were made before, or by other tools.

#include <filesystem>
#include <optional>

#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"

namespace planescope::app {

/// What a folder says about a frame: as `planescope segment` wrote it (frames/000123), as label
/// files, or in a format of exchange (000123.npy, .label, .npz, .ply, .pcd, .json). `gravity` is
/// that of the truth. nullopt where it holds nothing of the frame. Throws Error where that is
/// damaged or does not fit the frame.
std::optional<FrameLabels> read_prediction(const std::filesystem::path& dir,
                                           const io::Recording& recording,
                                           const Frame& frame,
                                           const Gravity& gravity);

}  // namespace planescope::app
