#pragma once

// JSON that somebody else may have written: parsing, and reading with errors that name the place in
// the document, what was found and what was expected. Structs are read and written by their fields:
// json_fields.hpp.

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

/// JSON that nests deeper is refused: what walks a tree walks it recursively.
inline constexpr int kDeepestJson = 64;

/// `depth`: as nlohmann's callbacks count it. Throws Error that begins with `what`.
void check_depth(int depth, const std::string& what);

/// JSON, with // and /* */ comments. Throws Error that begins with `what` where it is damaged,
/// nested too deeply, or has a key twice in one object. `Json`: nlohmann::json or ordered_json.
template <typename Json>
Json parse_json(std::string_view text, const std::string& what);

/// The same of a file, of at most `max_bytes`.
template <typename Json>
Json read_json(const std::filesystem::path& path,
               std::uintmax_t max_bytes = std::uintmax_t{1} << 26);

/// The text of a file. Bytes that are not UTF-8 are replaced: people may have typed anything.
std::string json_text(const nlohmann::ordered_json& json, int indent = 1);

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

/// A place in a document. Values that are not as expected are an Error that names the place:
/// `record.options[3].name is 7, expected text`. The JSON must live as long.
class JsonPlace {
 public:
  explicit JsonPlace(const nlohmann::ordered_json& json, std::string where = "");

  JsonPlace at(const char* key) const;
  bool has(const char* key) const;  // and is not null
  bool is_null() const;
  /// Throws Error on any other key: a misspelt one must not pass unnoticed.
  void has_only(std::initializer_list<std::string_view> keys) const;
  /// The list's items, one by one.
  void each(const std::function<void(const JsonPlace&)>& visit) const;
  /// The document's "schema", one of `readable`. Versions before these get a message of their own.
  std::string schema(std::initializer_list<std::string_view> readable) const;

  std::string text() const;
  bool boolean() const;
  double number() const;
  int whole(int low, int high = std::numeric_limits<int>::max()) const;
  std::uint64_t count(std::uint64_t high = std::numeric_limits<std::uint64_t>::max()) const;
  Vec3d vector() const;
  /// Which of the names it is.
  std::size_t choice(std::span<const char* const> names) const;
  const nlohmann::ordered_json& json() const { return *json_; }

  [[noreturn]] void fail_kind(const std::string& expected) const;

 private:
  JsonPlace maybe(const char* key) const;
  [[noreturn]] void fail(const std::string& what) const;

  const nlohmann::ordered_json* json_;
  std::string where_;
};

/// Calls `read` with the document's place; its Errors get the file's name in front.
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
