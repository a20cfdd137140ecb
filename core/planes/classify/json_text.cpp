#include "core/planes/classify/json_text.hpp"

#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "core/model/error.hpp"

namespace planescope::planes {
namespace {

using Json = nlohmann::json;

constexpr int kMaxDepth = 16;
constexpr std::size_t kMaxShown = 80;

}  // namespace

Json parse_json(std::string_view text, const std::string& what) {
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto check = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kMaxDepth)
      throw Error(what + ": nested deeper than " + std::to_string(kMaxDepth) + " levels");
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      throw Error(what + ": names " + shown(parsed.get<std::string>()) + " twice");
    return true;
  };
  Json json = Json::parse(text.begin(), text.end(), check, false);
  if (json.is_discarded()) throw Error(what + ": not valid JSON");
  return json;
}

std::string shown(const std::string& text) {
  const bool cut = text.size() > kMaxShown;
  return Json(cut ? text.substr(0, kMaxShown) + "..." : text)
      .dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace planescope::planes
