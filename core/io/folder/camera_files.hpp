#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/io/readers.hpp"

// Calibration files beside the images of a folder. Internal to core/io.

namespace planescope::io {

struct CameraFiles {
  CameraFacts depth;
  std::optional<Intrinsics> color;  // only where a file tells them apart from those of depth
  std::optional<Pose> T_color_depth;
};

/// Reads what calibration the folder has: JSON with `intrinsic_matrix` (and `depth_scale`), OpenCV
/// XML, or a text file of numbers. Throws Error when a file named as intrinsics is damaged.
CameraFiles find_camera_files(const std::filesystem::path& folder);

// One per format; nullopt where the file is of another kind.
std::optional<CameraFacts> camera_from_json(const std::filesystem::path& path);
std::optional<CameraFiles> camera_from_opencv_xml(const std::filesystem::path& path);
std::optional<CameraFacts> camera_from_text(const std::filesystem::path& path);

}  // namespace planescope::io
