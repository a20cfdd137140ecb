#pragma once

// Intrinsics for a recording whose files have none: where they may be found, and where to keep
// them.

#include <filesystem>
#include <string>
#include <vector>

#include "core/io/recording.hpp"

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
