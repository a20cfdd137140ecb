#pragma once

#include <filesystem>
#include <vector>

namespace planescope::io::rosbag2 {

/// The files that the metadata.yaml of a folder lists, in its order. Throws Error where it cannot
/// be read, names none, or one of them is not there.
std::vector<std::filesystem::path> files_of_metadata(const std::filesystem::path& folder);

}  // namespace planescope::io::rosbag2
