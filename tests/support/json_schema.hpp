#pragma once

// The subset of JSON Schema (draft 7) that our schemas use: type, const, enum, properties,
// required, additionalProperties, items, minItems, maxItems, minimum. Ignores `pattern` and
// descriptions.

#include <nlohmann/json.hpp>
#include <string>

namespace planescope {

inline bool has_schema_type(const nlohmann::json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  if (type == "boolean") return value.is_boolean();
  return type == "null" && value.is_null();
}

/// Returns an empty string if `value` is valid, otherwise where and how it violates `schema`.
inline std::string schema_error(const nlohmann::json& schema,
                                const nlohmann::json& value,
                                const std::string& at = "") {
  if (schema.contains("const") && value != schema["const"])
    return at + ": is not " + schema["const"].dump();
  if (schema.contains("enum")) {
    bool known = false;
    for (const auto& allowed : schema["enum"]) known = known || allowed == value;
    if (!known) return at + ": " + value.dump() + " is none of " + schema["enum"].dump();
  }
  if (schema.contains("type")) {
    const auto types = schema["type"].is_array() ? schema["type"] : nlohmann::json{schema["type"]};
    bool fits = false;
    for (const auto& type : types) fits = fits || has_schema_type(value, type);
    if (!fits) return at + ": " + value.dump().substr(0, 60) + " is no " + types.dump();
  }
  if (schema.contains("minimum") && value.is_number() && value < schema["minimum"])
    return at + ": is below " + schema["minimum"].dump();
  if (value.is_object()) {
    for (const auto& name : schema.value("required", nlohmann::json::array()))
      if (!value.contains(name.get<std::string>())) return at + ": lacks " + name.dump();
    const auto properties = schema.value("properties", nlohmann::json::object());
    for (const auto& [name, part] : value.items()) {
      if (properties.contains(name)) {
        const std::string error = schema_error(properties[name], part, at + "/" + name);
        if (!error.empty()) return error;
      } else if (schema.value("additionalProperties", true) == false) {
        return at + ": " + name + " is not in the schema";
      }
    }
  }
  if (value.is_array()) {
    if (value.size() < schema.value("minItems", std::size_t{0})) return at + ": too few items";
    if (value.size() > schema.value("maxItems", value.size())) return at + ": too many items";
    for (std::size_t i = 0; schema.contains("items") && i < value.size(); ++i) {
      const std::string error =
          schema_error(schema["items"], value[i], at + "/" + std::to_string(i));
      if (!error.empty()) return error;
    }
  }
  return "";
}

}  // namespace planescope
