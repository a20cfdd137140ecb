#pragma once

// The three files of a frame's labels as bytes, for those who need to know them before they are
// written or whether they are still the same.

#include <array>
#include <filesystem>
#include <vector>

#include "core/labels/model/label_files.hpp"

namespace planescope::labels {

inline constexpr std::size_t kLabelFiles = 3;  // plane image, h/v image, JSON: in this order

using LabelFileBytes = std::array<std::vector<unsigned char>, kLabelFiles>;

std::array<std::filesystem::path, kLabelFiles> label_file_paths(const std::filesystem::path& dir,
                                                                int frame_index);

/// False also where that cannot be found out.
bool is_there(const std::filesystem::path& path);

/// Throws Error, naming files in `dir`, where the labels are not consistent.
LabelFileBytes encode_label_files(const std::filesystem::path& dir,
                                  int frame_index,
                                  const FrameLabels& labels);
/// Makes the folder where needed.
void write_label_files(const std::filesystem::path& dir,
                       int frame_index,
                       const LabelFileBytes& bytes);

}  // namespace planescope::labels
