#pragma once

// Reads untrusted JSON, with errors that name the position in the document, what was found and what
// was expected. Structs are read and written by their fields: see json_fields.hpp.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "core/model/error.hpp"
#include "core/model/types.hpp"

namespace planescope {

/// Deeper nesting is an error, because trees are processed recursively.
inline constexpr int kDeepestJson = 64;

/// `depth`: as counted by nlohmann's callbacks. Throws Error beginning with `what`.
void check_depth(int depth, const std::string& what);

/// Parses JSON with // and /* */ comments. Throws Error beginning with `what` if it is damaged,
/// nested too deeply, or has duplicate keys in an object. `Json`: nlohmann::json or ordered_json.
template <typename Json>
Json parse_json(std::string_view text, const std::string& what);

/// Parses a file of at most `max_bytes`.
template <typename Json>
Json read_json(const std::filesystem::path& path,
               std::uintmax_t max_bytes = std::uintmax_t{1} << 26);

/// Text for a file. Bytes that are not UTF-8 are replaced, because users may have typed anything.
std::string json_text(const nlohmann::ordered_json& json, int indent = 1);

/// A whole number from `low` to `high`. Throws Error beginning with `what` for anything else;
/// nlohmann's get<int>() would truncate large numbers to their lowest bits.
template <typename Json>
std::int64_t whole_number(const Json& json,
                          std::int64_t low,
                          std::int64_t high,
                          const std::string& what);
/// A whole number in the range of int.
template <typename Json>
int whole_int(const Json& json, const std::string& what) {
  constexpr std::int64_t kMost = std::numeric_limits<int>::max();
  return static_cast<int>(whole_number(json, -kMost - 1, kMost, what));
}

/// Rounds to a nanometer, far below the resolution of any sensor; never minus zero.
double rounded(double value);
nlohmann::ordered_json vector_json(const Vec3d& v);  // rounded

/// Text from such a file for a message: quoted, ASCII only, shortened if long.
std::string shown(const std::string& text);

/// The description of an nlohmann exception, without its error number.
std::string json_problem(const std::exception& problem);

/// A position in a document. Unexpected values throw Error naming the position:
/// `record.options[3].name is 7; expected text`. The JSON must outlive this object.
class JsonPlace {
 public:
  explicit JsonPlace(const nlohmann::ordered_json& json, std::string where = "");

  JsonPlace at(const char* key) const;
  bool has(const char* key) const;  // and it is not null
  bool is_null() const;
  /// Throws Error for any other key, to detect misspelled keys.
  void has_only(std::initializer_list<std::string_view> keys) const;
  /// Visits the items of a list.
  void each(const std::function<void(const JsonPlace&)>& visit) const;
  /// The document's "schema", which must be one of `readable`. Older versions get a separate
  /// message.
  std::string schema(std::initializer_list<std::string_view> readable) const;

  std::string text() const;
  bool boolean() const;
  double number() const;
  int whole(int low, int high = std::numeric_limits<int>::max()) const;
  std::uint64_t count(std::uint64_t high = std::numeric_limits<std::uint64_t>::max()) const;
  Vec3d vector() const;
  /// The index of the name with this value.
  std::size_t choice(std::span<const char* const> names) const;
  const nlohmann::ordered_json& json() const { return *json_; }

  [[noreturn]] void fail_kind(const std::string& expected) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  JsonPlace maybe(const char* key) const;

  const nlohmann::ordered_json* json_;
  std::string where_;
};

/// Calls `read` with the document's root position; prefixes Errors with the file name.
template <typename Read>
auto read_place(const std::filesystem::path& file,
                const nlohmann::ordered_json& json,
                Read&& read) {
  try {
    return read(JsonPlace(json));
  } catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
  }
}

}  // namespace planescope
