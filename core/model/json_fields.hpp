#pragma once

// Converts structs to JSON and back. A struct lists its fields once, in file order, in a function
// in its own namespace (argument-dependent lookup does not search anonymous namespaces, unless the
// struct is also in one):
//
//   template <typename Fields>
//   void visit_fields(Fields& fields, Same<Rule> auto& rule) {
//     fields("metric", rule.metric);                   // text, numbers, structs, lists ...
//     fields("frame", rule.frame, kOptional);          // if missing, the member keeps its value
//     fields.with_default("note", rule.note, "");      // not written if it has that value
//     fields("level", rule.level);                     // an enum with names_of(Level)
//   }
//
// json_of(rule) writes it, read_fields(place, rule) reads it. If reading and writing differ, use
// `if constexpr (Fields::kReads)`.

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <ranges>
#include <string>
#include <type_traits>
#include <utility>

#include "core/model/json.hpp"

namespace planescope {

/// `const Struct` for writing, `Struct` for reading.
template <typename Type, typename Struct>
concept Same = std::same_as<std::remove_const_t<Type>, Struct>;

/// Format of a field in the file; flags.
enum FieldKind : unsigned {
  kPlain = 0,
  kCompared = 1,  // also read with Extent::compared
  kOptional = 2,  // may be missing or null: keeps its value
  kRounded = 4,   // written to a nanometer
  kOrNull = 8,    // empty text and NaN are null
  kSigned = 16,   // an int that may be negative
};

/// Part of a file to read: everything, as written by this version; or only kCompared fields, from a
/// file of any version.
enum class Extent : std::uint8_t { whole, compared };

class FieldWriter {
 public:
  static constexpr bool kReads = false;
  using Json = nlohmann::ordered_json;
  explicit FieldWriter(Json& json) : json_(json) {}

  template <typename Value>
  void operator()(const char* name, const Value& value, unsigned kind = kPlain) {
    write(member(json_, name), value, kind);
  }
  void whole(const char* name, int value, unsigned kind, int /*low*/, int /*high*/ = 0) {
    (*this)(name, value, kind);
  }
  template <typename Value>
  void with_default(const char* name,
                    const Value& value,
                    const std::type_identity_t<Value>& usual,
                    unsigned kind = kPlain) {
    if constexpr (std::floating_point<Value>)
      if (std::isnan(value) && std::isnan(usual)) return;
    if (value != usual) (*this)(name, value, kind);
  }
  /// Numbers, or enums by number.
  template <typename Value>
  void clamped(const char* name, Value value, double /*low*/, double /*high*/, unsigned = kPlain) {
    if constexpr (std::is_enum_v<Value>)
      (*this)(name, static_cast<int>(value));
    else
      (*this)(name, value);
  }
  /// The first `used` values.
  void numbers(const char* name, const auto& values, std::size_t used, const char* /*most*/) {
    Json& list = set_list(member(json_, name));
    for (std::size_t i = 0; i < used; ++i) write(append(list), values[i], kPlain);
  }
  void object(const char* name, unsigned /*kind*/, auto&& visit) {
    FieldWriter fields(set_object(member(json_, name)));
    visit(fields);
  }
  /// Null if missing.
  void maybe_object(const char* name, bool is_there, unsigned kind, auto&& visit) {
    if (is_there)
      object(name, kind, visit);
    else
      null(name);
  }
  /// Members of this object that exist together or not at all; `name`: one of them.
  void maybe_fields(const char* /*name*/, const auto& value, unsigned /*kind*/, auto&& visit) {
    if (value) visit(*this, *value);
  }
  void list(const char* name, const auto& values, unsigned /*kind*/, auto&& visit) {
    Json& list = set_list(member(json_, name));
    for (const auto& value : values) {
      FieldWriter fields(set_object(append(list)));
      visit(fields, value);
    }
  }
  void null(const char* name) { set(member(json_, name), nullptr); }
  /// For values with custom formats.
  Json& json() { return json_; }

 private:
  template <typename Value>
  static void write(Json& json, const Value& value, unsigned kind) {
    if constexpr (std::is_same_v<Value, std::filesystem::path>) {
      set(json, value.string());
    } else if constexpr (std::convertible_to<Value, std::string>) {
      const std::string text = value;
      (kind & kOrNull) != 0 && text.empty() ? set(json, nullptr) : set(json, text);
    } else if constexpr (std::floating_point<Value>) {
      set(json, (kind & kRounded) != 0 ? rounded(value) : value);  // NaN and infinity become null
    } else if constexpr (std::is_enum_v<Value>) {
      set(json, std::string(names_of(value)[static_cast<std::size_t>(value)]));
    } else if constexpr (std::is_same_v<Value, bool>) {
      set(json, value);
    } else if constexpr (std::unsigned_integral<Value>) {
      set(json, std::uint64_t{value});
    } else if constexpr (std::integral<Value>) {
      set(json, std::int64_t{value});
    } else if constexpr (std::is_same_v<Value, Vec3d>) {
      set_list(json);
      for (int k = 0; k < 3; ++k) write(append(json), value[k], kind);
    } else if constexpr (requires { value.has_value(); }) {
      value ? write(json, *value, kind) : set(json, nullptr);
    } else if constexpr (std::ranges::range<Value>) {
      set_list(json);
      for (const auto& one : value) write(append(json), one, kind);
    } else {
      FieldWriter fields(set_object(json));
      visit_fields(fields, value);
    }
  }

  static Json& member(Json& json, const char* name);
  static Json& append(Json& list);
  static Json& set_list(Json& json);
  static Json& set_object(Json& json);
  static void set(Json& json, std::nullptr_t);
  static void set(Json& json, const std::string& value);
  static void set(Json& json, double value);
  static void set(Json& json, bool value);
  static void set(Json& json, std::int64_t value);
  static void set(Json& json, std::uint64_t value);

  Json& json_;
};

/// Errors name the position.
class FieldReader {
 public:
  static constexpr bool kReads = true;
  explicit FieldReader(JsonPlace place, Extent extent = Extent::whole)
      : place_(std::move(place)), extent_(extent) {}

  template <typename Value>
  void operator()(const char* name, Value& value, unsigned kind = kPlain) {
    if (!is_read(name, kind)) return;
    const bool may_lack = (kind & kOrNull) != 0 || requires { value.has_value(); };
    if (may_lack && !place_.has(name)) {
      if constexpr (std::floating_point<Value>)
        value = std::nan("");
      else
        value = Value();
      return;
    }
    read(place_.at(name), value, kind);
  }
  void whole(const char* name, int& value, unsigned kind, int low, int high = kMost) {
    if (is_read(name, kind)) value = place_.at(name).whole(low, high);
  }
  template <typename Value>
  void with_default(const char* name,
                    Value& value,
                    const std::type_identity_t<Value>& usual,
                    unsigned kind = kPlain) {
    value = usual;
    (*this)(name, value, kind | kOptional);
  }
  template <typename Value>
  void clamped(const char* name, Value& value, double low, double high, unsigned kind = kPlain) {
    if (!is_read(name, kind)) return;
    double number = 0;
    if constexpr (std::floating_point<Value>)
      number = place_.at(name).number();
    else
      number = place_.at(name).whole(std::numeric_limits<int>::min());
    value = static_cast<Value>(std::clamp(number, low, high));
  }
  /// Fills the values from the front. Throws Error if there are more numbers than values; `most`
  /// describes the expected number.
  template <typename Values>
  void numbers(const char* name, Values& values, std::size_t /*used*/, const char* most) {
    if (!is_read(name, kPlain)) return;
    std::size_t i = 0;
    place_.at(name).each([&](const JsonPlace& number) {
      if (i == std::size(values)) number.fail_kind(most);
      read(number, values[i++], kPlain);
    });
  }
  template <typename Visit>
  void object(const char* name, unsigned kind, Visit&& visit) {
    if (!is_read(name, kind)) return;
    FieldReader fields(place_.at(name), extent_);
    visit(fields);
  }
  template <typename Visit>
  void maybe_object(const char* name, bool /*is_there*/, unsigned kind, Visit&& visit) {
    object(name, kind | kOptional, visit);
  }
  template <typename Value, typename Visit>
  void maybe_fields(const char* name, Value& value, unsigned kind, Visit&& visit) {
    if (is_read(name, kind | kOptional)) visit(*this, value.emplace());
  }
  template <typename Values, typename Visit>
  void list(const char* name, Values& values, unsigned kind, Visit&& visit) {
    if (!is_read(name, kind)) return;
    place_.at(name).each([&](const JsonPlace& place) {
      FieldReader fields(place, extent_);
      visit(fields, values.emplace_back());
    });
  }
  const JsonPlace& place() const { return place_; }
  bool is_read(const char* name, unsigned kind) const {
    if (extent_ == Extent::compared && (kind & kCompared) == 0) return false;
    return (kind & kOptional) == 0 || place_.has(name);
  }

 private:
  static constexpr int kMost = std::numeric_limits<int>::max();

  template <typename Value>
  void read(const JsonPlace& place, Value& value, unsigned kind) const {
    if constexpr (std::is_same_v<Value, std::string> ||
                  std::is_same_v<Value, std::filesystem::path>) {
      value = place.text();
    } else if constexpr (std::is_enum_v<Value>) {
      value = static_cast<Value>(place.choice(names_of(value)));
    } else if constexpr (std::is_same_v<Value, bool>) {
      value = place.boolean();
    } else if constexpr (std::floating_point<Value>) {
      value = static_cast<Value>(place.number());
    } else if constexpr (std::is_same_v<Value, int>) {
      value = place.whole((kind & kSigned) != 0 ? std::numeric_limits<int>::min() : 0);
    } else if constexpr (std::unsigned_integral<Value>) {
      value = static_cast<Value>(place.count(std::numeric_limits<Value>::max()));
    } else if constexpr (std::is_same_v<Value, std::int64_t>) {
      value = static_cast<Value>(place.count(std::numeric_limits<Value>::max()));
    } else if constexpr (std::is_same_v<Value, Vec3d>) {
      value = place.vector();
    } else if constexpr (requires { value.has_value(); }) {
      value.reset();
      if (!place.is_null()) read(place, value.emplace(), kind);
    } else if constexpr (requires { value.emplace_back(); }) {
      value.clear();
      place.each([&](const JsonPlace& one) { read(one, value.emplace_back(), kind); });
    } else if constexpr (std::ranges::range<Value>) {
      std::size_t i = 0;
      const std::string expected = std::to_string(std::size(value)) + " values";
      place.each([&](const JsonPlace& one) {
        if (i == std::size(value)) place.fail_kind(expected);
        read(one, value[i++], kind);
      });
      if (i < std::size(value)) place.fail_kind(expected);
    } else {
      FieldReader fields(place, extent_);
      visit_fields(fields, value);
    }
  }

  JsonPlace place_;
  Extent extent_;
};

/// For structs with visit_fields().
template <typename Json = nlohmann::ordered_json>
Json json_of(const auto& value) {
  Json json = Json::object();
  FieldWriter fields(json);
  visit_fields(fields, value);
  return json;
}
/// Throws Error naming the position.
void read_fields(const JsonPlace& place, auto& value) {
  FieldReader fields(place);
  visit_fields(fields, value);
}

}  // namespace planescope
