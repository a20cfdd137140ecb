#pragma once

#include <filesystem>
#include <vector>

// Internal to core/io.

namespace planescope::io {

struct RawFile {
  std::filesystem::path raw;
  std::filesystem::path csv;
};

/// Depth snapshots of the RealSense Viewer: at the .raw or .csv given, or all in the folder given.
std::vector<RawFile> viewer_raw_files(const std::filesystem::path& path);

}  // namespace planescope::io
