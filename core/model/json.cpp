// JSON with limits on depth and size, and errors naming the position in the document.

#include "core/model/json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"

namespace planescope {

double rounded(double value) {
  return std::round(value * 1e9) / 1e9 + 0.0;  // + 0.0 avoids minus zero
}

nlohmann::ordered_json vector_json(const Vec3d& v) {
  return nlohmann::ordered_json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())});
}

void check_depth(int depth, const std::string& what) {
  if (depth > kDeepestJson)
    throw Error(what + ": JSON nested deeper than " + std::to_string(kDeepestJson) + " levels");
}

template <typename Json>
Json parse_json(std::string_view text, const std::string& what) {
  std::vector<std::set<std::string>> keys;  // keys of the open objects
  const auto check = [&](int depth, typename Json::parse_event_t event, const Json& value) {
    using Event = typename Json::parse_event_t;
    check_depth(depth, what);
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key) {
      const auto& key = value.template get_ref<const std::string&>();
      if (!keys.back().insert(key).second)
        throw Error(what + ": " + shown(key) + " appears twice in one object");
    }
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), check, true, true);
  } catch (const typename Json::exception& problem) {
    throw Error(what + ": not valid JSON: " + json_problem(problem));
  }
}

template <typename Json>
Json read_json(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  const auto bytes = read_file_bytes(path, max_bytes);
  return parse_json<Json>({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                          path.string());
}

template nlohmann::json parse_json(std::string_view, const std::string&);
template nlohmann::ordered_json parse_json(std::string_view, const std::string&);
template nlohmann::json read_json(const std::filesystem::path&, std::uintmax_t);
template nlohmann::ordered_json read_json(const std::filesystem::path&, std::uintmax_t);

template <typename Json>
std::int64_t whole_number(const Json& json,
                          std::int64_t low,
                          std::int64_t high,
                          const std::string& what) {
  bool fits = json.is_number_integer();
  if (json.is_number_unsigned())
    fits = std::in_range<std::int64_t>(json.template get<std::uint64_t>());
  const auto value = fits ? json.template get<std::int64_t>() : std::int64_t{0};
  if (!fits || value < low || value > high)
    throw Error(what + " is " + (json.is_number() ? json.dump() : "not a number") +
                "; expected a whole number from " + std::to_string(low) + " to " +
                std::to_string(high));
  return value;
}

template std::int64_t whole_number(const nlohmann::json&,
                                   std::int64_t,
                                   std::int64_t,
                                   const std::string&);
template std::int64_t whole_number(const nlohmann::ordered_json&,
                                   std::int64_t,
                                   std::int64_t,
                                   const std::string&);

std::string shown(const std::string& text) {
  constexpr std::size_t kMost = 80;
  const bool cut = text.size() > kMost;
  return nlohmann::json(cut ? text.substr(0, kMost) + "..." : text)
      .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

std::string json_problem(const std::exception& problem) {
  const std::string text = problem.what();
  const std::size_t at = text.starts_with("[json.exception") ? text.find("] ") : std::string::npos;
  return at == std::string::npos ? text : text.substr(at + 2);
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

// ---- Places ----

JsonPlace::JsonPlace(const nlohmann::ordered_json& json, std::string where)
    : json_(&json), where_(std::move(where)) {}

JsonPlace JsonPlace::at(const char* key) const {
  JsonPlace place = maybe(key);
  if (!place.json_) fail("has no \"" + std::string(key) + "\"");
  return place;
}

bool JsonPlace::has(const char* key) const {
  if (!json_->is_object()) fail_kind("an object");
  const auto found = json_->find(key);
  return found != json_->end() && !found->is_null();
}

bool JsonPlace::is_null() const { return json_->is_null(); }

void JsonPlace::has_only(std::initializer_list<std::string_view> keys) const {
  if (!json_->is_object()) fail_kind("an object");
  for (const auto& item : json_->items())
    if (std::ranges::find(keys, item.key()) == keys.end())
      fail(fmt::format("has an unknown key, {}; expected one of {}", shown(item.key()),
                       fmt::join(keys, ", ")));
}

void JsonPlace::each(const std::function<void(const JsonPlace&)>& visit) const {
  if (!json_->is_array()) fail_kind("a list");
  for (std::size_t i = 0; i < json_->size(); ++i)
    visit(JsonPlace((*json_)[i], fmt::format("{}[{}]", where_, i)));
}

std::string JsonPlace::schema(std::initializer_list<std::string_view> readable) const {
  const std::string expected = fmt::format("{}", fmt::join(readable, " or "));
  if (!has("schema")) fail("has no \"schema\"; expected " + expected);
  const JsonPlace place = at("schema");
  const std::string found = place.text();
  if (std::ranges::find(readable, found) != readable.end()) return found;
  const auto stem = [](std::string_view schema) { return schema.substr(0, schema.rfind('/')); };
  const auto version = [](std::string_view schema) {
    return parse_number(schema.substr(schema.rfind('/') + 1)).value_or(std::nan(""));
  };
  if (stem(found) == stem(*readable.begin()) && version(found) < version(*readable.begin()))
    throw Error(found + " is no longer supported; expected " + expected);
  place.fail_kind(expected);
}

std::string JsonPlace::text() const {
  if (!json_->is_string()) fail_kind("text");
  return json_->get<std::string>();
}

bool JsonPlace::boolean() const {
  if (!json_->is_boolean()) fail_kind("true or false");
  return json_->get<bool>();
}

double JsonPlace::number() const {
  if (!json_->is_number()) fail_kind("a number");
  return json_->get<double>();
}

int JsonPlace::whole(int low, int high) const {
  // Compares as double, because the number may have any size.
  if (!json_->is_number_integer() || number() < low || number() > high)
    fail_kind(fmt::format("a whole number from {} to {}", low, high));
  return json_->get<int>();
}

std::uint64_t JsonPlace::count(std::uint64_t high) const {
  if (!json_->is_number_unsigned() || json_->get<std::uint64_t>() > high)
    fail_kind(high < std::numeric_limits<std::uint64_t>::max()
                  ? fmt::format("a whole number from 0 to {}", high)
                  : "a nonnegative whole number");
  return json_->get<std::uint64_t>();
}

Vec3d JsonPlace::vector() const {
  if (!json_->is_array() || json_->size() != 3) fail_kind("three numbers");
  Vec3d v;
  int k = 0;
  each([&](const JsonPlace& place) { v[k++] = place.number(); });
  return v;
}

std::size_t JsonPlace::choice(std::span<const char* const> names) const {
  const std::string found = text();
  const auto at = std::ranges::find(names, found);
  if (at == names.end()) fail_kind(fmt::format("one of {}", fmt::join(names, ", ")));
  return static_cast<std::size_t>(at - names.begin());
}

void JsonPlace::fail_kind(const std::string& expected) const {
  constexpr std::size_t kMostShown = 40;
  std::string found = json_->dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (found.size() > kMostShown) found = found.substr(0, kMostShown) + "...";
  fail("is " + found + "; expected " + expected);
}

JsonPlace JsonPlace::maybe(const char* key) const {
  if (!json_->is_object()) fail_kind("an object");
  const auto found = json_->find(key);
  JsonPlace place = *this;
  place.json_ = found == json_->end() ? nullptr : &*found;
  place.where_ += where_.empty() ? key : std::string(".") + key;
  return place;
}

void JsonPlace::fail(const std::string& what) const {
  throw Error((where_.empty() ? "the file" : where_) + " " + what);
}

// ---- Fields ----

void FieldWriter::set(Json& json, std::nullptr_t) { json = nullptr; }
void FieldWriter::set(Json& json, const std::string& value) { json = value; }
void FieldWriter::set(Json& json, double value) { json = value; }
void FieldWriter::set(Json& json, bool value) { json = value; }
void FieldWriter::set(Json& json, std::int64_t value) { json = value; }
void FieldWriter::set(Json& json, std::uint64_t value) { json = value; }
FieldWriter::Json& FieldWriter::set_list(Json& json) { return json = Json::array(); }
FieldWriter::Json& FieldWriter::set_object(Json& json) { return json = Json::object(); }
FieldWriter::Json& FieldWriter::member(Json& json, const char* name) { return json[name]; }
FieldWriter::Json& FieldWriter::append(Json& list) { return list.emplace_back(); }

}  // namespace planescope
