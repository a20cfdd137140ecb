#pragma once

// Calibration files beside the images of a folder. Internal to core/io.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/io/readers.hpp"
#include "core/io/recording.hpp"

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

// Intrinsics for a recording whose files have none: where they may be found, and where to keep
// them.

namespace planescope::io {

/// Intrinsics that may be those of a recording.
struct CameraChoice {
  std::string name;  // the file that has them, or the camera
  Intrinsics intrinsics;
  double depth_unit_m = 0.001;  // m per count
  bool from_file = false;
};

/// Intrinsics for depth images of the recording's size: those in files of neighboring folders
/// first, then nominal values of common cameras. Damaged files are skipped.
std::vector<CameraChoice> camera_choices(const RecordingInfo& info);

/// The camera whose nominal values these are; empty: none.
std::string nominal_camera(const Intrinsics& intrinsics);

/// `<recording>.planescope.json` beside the recording.
std::filesystem::path camera_file(const RecordingInfo& info);
/// Stores the recording's intrinsics and depth unit in camera_file(), and keeps what else that
/// file has. Throws Error.
void remember_camera(const RecordingInfo& info);

}  // namespace planescope::io
