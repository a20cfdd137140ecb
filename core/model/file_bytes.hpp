#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <span>
#include <string_view>
#include <vector>

namespace planescope {

/// The whole of a file. Throws Error naming the path when it is missing, no regular file, cannot
/// be read or is larger than `max_bytes` (a guard for files that are read whole).
std::vector<unsigned char> read_file_bytes(const std::filesystem::path& path,
                                           std::uintmax_t max_bytes = std::uintmax_t{1} << 30);

enum class Durable : bool { no, yes };  // `yes`: survives a loss of power as well; slower

/// Replaces a file: what it is to hold is written beside it and then takes its name. Whoever reads
/// meanwhile, and whatever goes wrong, there is the old file or the new one, whole. A link stays
/// one; a pipe or a device is written to as it is. Throws Error naming the path; the old file then
/// stays.
void write_file_bytes(const std::filesystem::path& path,
                      std::span<const unsigned char> bytes,
                      Durable durable = Durable::no);
void write_file_text(const std::filesystem::path& path,
                     std::string_view text,
                     Durable durable = Durable::no);
/// For what is too large to be held; `write` may throw.
void write_file_stream(const std::filesystem::path& path,
                       const std::function<void(std::ostream&)>& write);

}  // namespace planescope
