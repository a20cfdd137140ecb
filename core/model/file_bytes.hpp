#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace planescope {

/// The whole of a file. Throws Error naming the path when it is missing, no regular file, cannot
/// be read or is larger than `max_bytes` (a guard for files that are read whole).
std::vector<unsigned char> read_file_bytes(const std::filesystem::path& path,
                                           std::uintmax_t max_bytes = std::uintmax_t{1} << 30);

/// Replaces a file by these bytes. Throws Error naming the path when they cannot all be written.
void write_file_bytes(const std::filesystem::path& path, std::span<const unsigned char> bytes);
void write_file_text(const std::filesystem::path& path, std::string_view text);

}  // namespace planescope
