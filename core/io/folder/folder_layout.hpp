#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// Internal to core/io.

namespace planescope::io {

/// Which images of a folder are depth, and which colour belongs to each.
struct FolderLayout {
  std::vector<std::filesystem::path> depth;  // in natural order
  std::vector<std::filesystem::path> color;  // one per depth image, empty path where none
  bool tum = false;                          // depth.txt and rgb.txt beside the folders
  /// Per depth image, its time from a list or a file name: its own, else that of its color image.
  std::vector<std::optional<double>> time_s;
  std::string times_source;  // "depth.txt", "file names"; empty: unknown
  std::vector<std::string> warnings;
  bool has_color() const;
};

/// Looks for depth/ with color/ or rgb/, else for names such as 000_depth.png and 000_color.png in
/// the folder itself, else for 16-bit grey PNGs there. No depth images: an empty layout. Throws
/// Error where a list of images beside them is damaged.
FolderLayout find_folder_layout(const std::filesystem::path& folder);

/// A point of time in a file name: the last number of it when it has at least ten digits before
/// the point, the first not 0 (seconds, milli-, micro- or nanoseconds since 1970). [s]
std::optional<double> timestamp_in_name(const std::filesystem::path& path);

}  // namespace planescope::io
