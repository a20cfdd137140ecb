#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace planescope::io {

/// Parses a JSON file of at most a few megabytes. Throws Error naming it.
nlohmann::json read_json_file(const std::filesystem::path& path);

}  // namespace planescope::io
