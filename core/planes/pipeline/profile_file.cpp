#include "core/planes/pipeline/profile_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::planes {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.profile/1";

const char* type_of(OptionKind kind) {
  if (kind == OptionKind::on_off) return "true or false";
  return kind == OptionKind::number || kind == OptionKind::whole ? "a number" : "a text";
}

/// As OptionInfo::set takes it. Throws Error where the value is of another type than the option.
std::string value_text(const OptionInfo& info, const Json& value) {
  if (info.kind == OptionKind::on_off && value.is_boolean())
    return value.get<bool>() ? "on" : "off";
  if (info.is_number() && value.is_number_float()) return fmt::format("{}", value.get<double>());
  if (info.is_number() && value.is_number()) return value.dump();
  if (info.kind != OptionKind::on_off && !info.is_number() && value.is_string())
    return value.get<std::string>();
  throw Error(fmt::format("option {}: found {}, expected {}", info.name,
                          value.is_string() ? shown(value.get<std::string>()) : value.dump(),
                          type_of(info.kind)));
}

Json value_json(const OptionInfo& info, const std::string& text) {
  if (info.kind == OptionKind::on_off) return text == "on";
  return info.is_number() ? Json::parse(text) : Json(text);
}

ProfileFile profile_of(const Json& json) {
  if (!json.is_object()) throw Error("is no profile, expected an object with a schema");
  ProfileFile profile;
  for (const auto& [key, value] : json.items()) {
    if (key == "options" && !value.is_object()) throw Error("its options are no object");
    if (key == "options") continue;
    if (key != "schema" && key != "base")
      throw Error(fmt::format("{} is unknown, expected schema, base and options", shown(key)));
    if (!value.is_string()) throw Error(fmt::format("its {} is no text", key));
  }
  const std::string schema = json.value("schema", "");
  if (schema != kSchema)
    throw Error(fmt::format("its schema is {}, expected {}", shown(schema), kSchema));
  profile.base = find_profile(json.value("base", "refined"));
  PipelineOptions options;
  options.segment = profile_options(profile.base);
  const Json named = json.value("options", Json::object());
  for (const auto& [name, value] : named.items()) {
    if (name == "profile") throw Error("option profile: the profile to begin with is its base");
    const OptionInfo& info = find_option(name);
    profile.options.emplace_back(name, value_text(info, value));
    info.set(options, profile.options.back().second);
  }
  return profile;
}

bool names_file(const std::string& text) {
  if (std::ranges::count(find_option("profile").choices, text) > 0) return false;
  std::error_code ignored;
  return text.find_first_of("./") != std::string::npos || fs::exists(text, ignored);
}

}  // namespace

ProfileFile read_profile(const fs::path& path) {
  constexpr std::uintmax_t kMostBytes = 1 << 20;
  const auto json = read_json<Json>(path, kMostBytes);
  try {
    return profile_of(json);
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
}

std::string profile_text(const ProfileFile& profile) {
  Json json;
  json["schema"] = kSchema;
  json["base"] = to_string(profile.base);
  json["options"] = Json::object();
  for (const auto& [name, value] : profile.options)
    json["options"][name] = value_json(find_option(name), value);
  return json.dump(2) + "\n";
}

void set_profile(PipelineOptions& options, const std::string& name_or_file) {
  if (!names_file(name_or_file)) {
    options.segment = profile_options(find_profile(name_or_file));
    return;
  }
  const ProfileFile profile = read_profile(name_or_file);
  options.segment = profile_options(profile.base);
  for (const auto& [name, value] : profile.options) set_option(options, name, value);
}

}  // namespace planescope::planes
