#pragma once

// Bags that were compressed as a whole, as `ros2 bag record --compression-mode file` does.

#include <filesystem>
#include <string>

#include "core/io/mapped_file.hpp"

namespace planescope::io {

/// Of a packed file "rec_0.db3.zstd" the name "rec_0.db3", of others their own.
std::filesystem::path name_within(const std::filesystem::path& path);

/// The first `count` bytes of what the file holds, fewer where it is shorter.
std::string first_bytes_within(const std::filesystem::path& path, std::size_t count);

/// Maps a file, or what it holds where it is zstd: that is unpacked into a file without a name, in
/// the folder for temporary files, which is gone with the mapping. Of a packed file that is cut or
/// damaged what comes before. Throws Error where nothing does, where there is no room, and where it
/// grows as no recording does.
MappedFile map_content(const std::filesystem::path& path);

}  // namespace planescope::io
