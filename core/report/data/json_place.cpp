#include "core/report/data/json_place.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"

namespace planescope::report {

namespace {
using Json = nlohmann::ordered_json;
}

JsonPlace::JsonPlace(const Json& json, std::string where)
    : json_(&json), where_(std::move(where)) {}

JsonPlace JsonPlace::at(const char* key) const {
  JsonPlace place = maybe(key);
  if (!place.json_) fail("has no \"" + std::string(key) + "\"");
  return place;
}

bool JsonPlace::has(const char* key) const {
  const JsonPlace place = maybe(key);
  return place.json_ && !place.json_->is_null();
}

void JsonPlace::has_only(std::initializer_list<std::string_view> keys) const {
  if (!json_->is_object()) fail_kind("an object");
  for (const auto& item : json_->items())
    if (std::find(keys.begin(), keys.end(), item.key()) == keys.end())
      fail(fmt::format("has \"{}\", expected one of {}", item.key(), fmt::join(keys, ", ")));
}

void JsonPlace::each(const std::function<void(const JsonPlace&)>& visit) const {
  if (!json_->is_array()) fail_kind("a list");
  for (std::size_t i = 0; i < json_->size(); ++i)
    visit(JsonPlace((*json_)[i], fmt::format("{}[{}]", where_, i)));
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
  // As a double: a number of any size can be compared with the limits.
  if (!json_->is_number_integer() || number() < low || number() > high)
    fail_kind(fmt::format("a whole number from {} to {}", low, high));
  return json_->get<int>();
}

std::uint64_t JsonPlace::count() const {
  if (!json_->is_number_unsigned()) fail_kind("a whole number from 0 on");
  return json_->get<std::uint64_t>();
}

Vec3d JsonPlace::vector() const {
  if (!json_->is_array() || json_->size() != 3) fail_kind("three numbers");
  Vec3d v;
  int k = 0;
  each([&](const JsonPlace& place) { v[k++] = place.number(); });
  return v;
}

void JsonPlace::fail_kind(const std::string& expected) const {
  constexpr std::size_t kMostShown = 40;
  std::string found = json_->dump(-1, ' ', false, Json::error_handler_t::replace);
  if (found.size() > kMostShown) found = found.substr(0, kMostShown) + "...";
  fail("is " + found + ", expected " + expected);
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

Json read_report_json(
    const std::filesystem::path& file,
    const std::function<void(std::size_t recording, const JsonPlace& frame)>& on_frame) {
  // Depths: the report 0, a recording 2, a frame 4.
  std::string member, member_of_recording, first_error;
  std::size_t recordings = 0, frames = 0;
  int times_there = 0;
  const auto take = [&](int depth, Json::parse_event_t event, Json& parsed) {
    check_depth(depth, file.string());
    if (event == Json::parse_event_t::key && depth == 1) {
      member = parsed.get<std::string>();
      times_there += member == "recordings";
      member_of_recording.clear();
    }
    if (member != "recordings") return true;
    if (event == Json::parse_event_t::key && depth == 3)
      member_of_recording = parsed.get<std::string>();
    if (event == Json::parse_event_t::object_start && depth == 2) {
      ++recordings;
      frames = 0;
      member_of_recording.clear();
    }
    if (event != Json::parse_event_t::object_end || depth != 4 || recordings == 0 ||
        member_of_recording != "frames")
      return true;
    try {
      on_frame(recordings - 1,
               JsonPlace(parsed, fmt::format("recordings[{}].frames[{}]", recordings - 1, frames)));
    } catch (const Error& error) {
      if (first_error.empty()) first_error = error.what();
    }
    ++frames;
    return false;
  };
  std::ifstream stream = open_to_read(file);
  Json json = Json::parse(stream, take, false);
  if (json.is_discarded()) throw Error(file.string() + ": not valid JSON");
  read_place(file, json, [](const JsonPlace& place) {
    const JsonPlace schema = place.at("schema");
    const std::string text = schema.text();
    if (text != "planescope.report/1" && text != "planescope.report/2" &&
        text != "planescope.report/3" && text != "planescope.report/4")
      schema.fail_kind("planescope.report/1, 2, 3 or 4");
  });
  if (times_there > 1) throw Error(file.string() + ": has \"recordings\" twice");
  if (!first_error.empty()) throw Error(file.string() + ": " + first_error);
  return json;
}

}  // namespace planescope::report
