#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace planescope {

/// JSON that nests deeper is refused: what walks a tree walks it recursively.
inline constexpr int kDeepestJson = 64;

/// `depth`: as nlohmann's callbacks count it. Throws Error that begins with `what`.
void check_depth(int depth, const std::string& what);

/// JSON, with // and /* */ comments, that somebody else may have written. Throws Error that begins
/// with `what` where it is damaged, nested too deeply, or has a key twice in one object. `Json`:
/// nlohmann::json or nlohmann::ordered_json.
template <typename Json>
Json parse_json(std::string_view text, const std::string& what);

/// The same of a file, of at most `max_bytes`.
template <typename Json>
Json read_json(const std::filesystem::path& path,
               std::uintmax_t max_bytes = std::uintmax_t{1} << 26);

/// Text from such a file for a message: quoted, in ASCII, cut where it is long.
std::string shown(const std::string& text);

/// What is wrong, without the library's own number of the error.
std::string json_problem(const std::exception& problem);

}  // namespace planescope
