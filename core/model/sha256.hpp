#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace planescope {

/// SHA-256 as 64 lower-case hex digits.
std::string sha256_hex(std::span<const std::byte> bytes);
std::string sha256_hex(std::string_view text);
/// Throws Error if the file cannot be read.
std::string sha256_hex_of_file(const std::filesystem::path& path);

}  // namespace planescope
