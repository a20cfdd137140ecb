#pragma once

#include <filesystem>
#include <string>
#include <vector>

// What kinds of files lie where. Internal to core/io.

namespace planescope::io {

/// File extension in lower case, with its dot.
std::string extension(const std::filesystem::path& path);
// By extension: .ply, .pcd, and the cloud formats that were added.
bool is_ply(const std::filesystem::path& path);
bool is_pcd(const std::filesystem::path& path);
bool is_cloud(const std::filesystem::path& path);

/// Orders names as people do: 2 before 10.
bool natural_less(const std::string& a, const std::string& b);

/// Regular files in a folder, hidden ones left out, in natural order. Throws Error naming the
/// folder when it cannot be listed.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder);
/// All .ply and .pcd files in a folder, then those in the folders below it. Where there is none,
/// all files of the formats that were added, in the same order.
std::vector<std::filesystem::path> cloud_files_under(const std::filesystem::path& folder);

}  // namespace planescope::io
