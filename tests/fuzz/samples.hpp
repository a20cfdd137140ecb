#pragma once

// What targets read into and seeds are made of.

#include "core/labels/model/grid.hpp"
#include "fuzz/fuzz.hpp"

namespace planescope::fuzz {

inline constexpr int kWidth = 8, kHeight = 6;

/// A wall, a floor and a hole.
Frame sample_frame();
/// 24 x 16 pixels, all of them alike.
Image16 plain_depth();
const labels::LabelGrid& label_grid();
/// Of that frame: nothing drawn yet.
FrameLabels blank_labels(int frame);

/// Empty where there is no file.
ByteVector bytes_of_file(const std::filesystem::path& path);

}  // namespace planescope::fuzz
