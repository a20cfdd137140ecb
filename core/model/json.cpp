#include "core/model/json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope {

double rounded(double value) {
  return std::round(value * 1e9) / 1e9 + 0.0;  // + 0.0: no minus zero
}

nlohmann::ordered_json vector_json(const Vec3d& v) {
  return {rounded(v.x()), rounded(v.y()), rounded(v.z())};
}

void check_depth(int depth, const std::string& what) {
  if (depth > kDeepestJson)
    throw Error(what + ": JSON nested deeper than " + std::to_string(kDeepestJson) + " levels");
}

template <typename Json>
Json parse_json(std::string_view text, const std::string& what) {
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto check = [&](int depth, typename Json::parse_event_t event, const Json& value) {
    using Event = typename Json::parse_event_t;
    check_depth(depth, what);
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key) {
      const auto& key = value.template get_ref<const std::string&>();
      if (!keys.back().insert(key).second)
        throw Error(what + ": has " + shown(key) + " twice in one object");
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
    throw Error(what + " is " + (json.is_number() ? json.dump() : "no number") +
                ", expected a whole number from " + std::to_string(low) + " to " +
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

}  // namespace planescope
