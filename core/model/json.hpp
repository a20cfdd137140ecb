#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "core/model/types.hpp"

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

/// A whole number from `low` to `high`. Throws Error that begins with `what` on anything else: the
/// library's own get<int>() takes the lowest bits of a number of any size.
template <typename Json>
std::int64_t whole_number(const Json& json,
                          std::int64_t low,
                          std::int64_t high,
                          const std::string& what);
/// One that an int holds.
template <typename Json>
int whole_int(const Json& json, const std::string& what) {
  constexpr std::int64_t kMost = std::numeric_limits<int>::max();
  return static_cast<int>(whole_number(json, -kMost - 1, kMost, what));
}

/// To a nanometer, which is far below what any sensor resolves; never minus zero.
double rounded(double value);
nlohmann::ordered_json vector_json(const Vec3d& v);  // rounded

/// Text from such a file for a message: quoted, in ASCII, cut where it is long.
std::string shown(const std::string& text);

/// What is wrong, without the library's own number of the error.
std::string json_problem(const std::exception& problem);

}  // namespace planescope
