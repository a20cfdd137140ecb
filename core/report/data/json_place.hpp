#pragma once

// JSON that somebody else may have written: what is missing, unknown, there twice or of another
// kind than expected is answered here, for every file that core/report reads. Internal to
// core/report.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "core/model/error.hpp"
#include "core/model/types.hpp"

namespace planescope::report {

/// A place in a file, to read from; what is not as expected is an Error that names the place. The
/// JSON must live as long.
class JsonPlace {
 public:
  explicit JsonPlace(const nlohmann::ordered_json& json, std::string where = "");

  JsonPlace at(const char* key) const;
  bool has(const char* key) const;  // and is not null
  /// Throws Error on any other key: a misspelt one must not pass unnoticed.
  void has_only(std::initializer_list<std::string_view> keys) const;
  void each(const std::function<void(const JsonPlace&)>& visit) const;

  std::string text() const;
  bool boolean() const;
  double number() const;
  int whole(int low, int high = std::numeric_limits<int>::max()) const;
  std::uint64_t count() const;
  Vec3d vector() const;
  /// The value that to_string() writes as this text. `expected`: what to say where there is none.
  template <typename Enum>
  Enum choice(std::initializer_list<Enum> values, const std::string& expected) const {
    const std::string found = text();
    for (const Enum value : values)
      if (found == to_string(value)) return value;
    fail_kind(expected);
  }
  const nlohmann::ordered_json& json() const { return *json_; }

  [[noreturn]] void fail_kind(const std::string& expected) const;

 private:
  JsonPlace maybe(const char* key) const;
  [[noreturn]] void fail(const std::string& what) const;

  const nlohmann::ordered_json* json_;
  std::string where_;
};

/// Calls `read` with the whole file's place; its Errors get the file's name in front.
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

/// A report.json without its frames, which need not fit into memory: each is passed to `on_frame`
/// with its recording's and its own position as it is read, and then dropped.
nlohmann::ordered_json read_report_json(
    const std::filesystem::path& file,
    const std::function<void(std::size_t recording, const JsonPlace& frame)>& on_frame);

}  // namespace planescope::report
