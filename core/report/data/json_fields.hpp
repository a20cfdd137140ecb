#pragma once

// Names the members of a struct in JSON once, for writing and for reading: a function
//   template <typename Fields> void NAME_fields(Fields& fields, auto& value)
// calls `fields` for each member, in the order of the file, with a FieldWriter or a FieldReader.
// What differs between the two stands behind `if constexpr (Fields::kReads)`. Internal to
// core/report/data.

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>

#include "core/report/data/json_place.hpp"

namespace planescope::report {

/// How a member stands in the file; flags to be combined.
enum FieldKind : unsigned {
  kPlain = 0,
  kCompared = 1,  // a baseline needs it, of whatever version it is
  kLate = 2,      // files of earlier versions lack it: the value then stays as it is
  kRounded = 4,   // to a nanometre
  kOrNull = 8,    // empty text, and NaN, are null
};

class FieldWriter {
 public:
  static constexpr bool kReads = false;
  explicit FieldWriter(nlohmann::ordered_json& json) : json_(json) {}

  void operator()(const char* name, const std::string& text, unsigned kind = kPlain);
  void operator()(const char* name, double value, unsigned kind = kPlain);
  void operator()(const char* name, bool value, unsigned kind = kPlain);
  void operator()(const char* name, int value, unsigned kind = kPlain);
  void operator()(const char* name, std::uint32_t value, unsigned kind = kPlain);
  void operator()(const char* name, std::uint64_t value, unsigned kind = kPlain);
  void operator()(const char* name, const Vec3d& value, unsigned kind = kPlain);  // rounded
  void whole(const char* name, int value, unsigned kind, int /*low*/, int /*high*/ = 0) {
    (*this)(name, value, kind);
  }
  template <typename Enum>
  void choice(const char* name, Enum value, std::initializer_list<Enum>, const char* /*expected*/) {
    (*this)(name, std::string(to_string(value)));
  }
  /// The first `used` of them.
  template <typename Values>
  void numbers(const char* name, const Values& values, std::size_t used, const char* /*most*/) {
    begin_list(name);
    for (std::size_t i = 0; i < used; ++i) append(name, values[i]);
  }
  template <typename Visit>
  void object(const char* name, unsigned /*kind*/, Visit&& visit) {
    FieldWriter fields = begin_object(name);
    visit(fields);
  }
  /// Null where it is not there.
  template <typename Visit>
  void maybe_object(const char* name, bool is_there, unsigned kind, Visit&& visit) {
    if (is_there)
      object(name, kind, visit);
    else
      null(name);
  }
  /// Members of this object that stand there together, or not at all; `name`: one of them.
  template <typename Value, typename Visit>
  void maybe_fields(const char* /*name*/, const Value& value, unsigned /*kind*/, Visit&& visit) {
    if (value) visit(*this, *value);
  }
  template <typename Values, typename Visit>
  void list(const char* name, const Values& values, unsigned /*kind*/, Visit&& visit) {
    begin_list(name);
    for (const auto& value : values) {
      FieldWriter fields = append_object(name);
      visit(fields, value);
    }
  }
  void null(const char* name);
  /// For what only the writer knows how to put.
  nlohmann::ordered_json& json() { return json_; }

 private:
  FieldWriter begin_object(const char* name);
  void begin_list(const char* name);
  void append(const char* name, double value);
  void append(const char* name, std::uint32_t value);
  FieldWriter append_object(const char* name);

  nlohmann::ordered_json& json_;
};

/// How much of a file is read: all of it, as this version writes it; or what is kCompared alone, of
/// a file of any version.
enum class Extent : std::uint8_t { whole, compared };

/// Its Errors name the place.
class FieldReader {
 public:
  static constexpr bool kReads = true;
  FieldReader(JsonPlace place, Extent extent) : place_(std::move(place)), extent_(extent) {}

  template <typename Value>
  void operator()(const char* name, Value& value, unsigned kind = kPlain) {
    if (is_read(name, kind)) read(name, value, kind);
  }
  void whole(const char* name, int& value, unsigned kind, int low, int high = kMost) {
    if (is_read(name, kind)) value = place_.at(name).whole(low, high);
  }
  template <typename Enum>
  void choice(const char* name,
              Enum& value,
              std::initializer_list<Enum> values,
              const char* expected) {
    if (is_read(name, kPlain)) value = place_.at(name).choice(values, expected);
  }
  /// Fills the values from the front. More numbers than there are values is an Error: `most` is
  /// what was expected.
  template <typename Values>
  void numbers(const char* name, Values& values, std::size_t /*used*/, const char* most) {
    if (!is_read(name, kPlain)) return;
    std::size_t i = 0;
    place_.at(name).each([&](const JsonPlace& number) {
      if (i == std::size(values)) number.fail_kind(most);
      read_number(number, values[i++]);
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
    object(name, kind | kLate, visit);
  }
  template <typename Value, typename Visit>
  void maybe_fields(const char* name, Value& value, unsigned kind, Visit&& visit) {
    if (is_read(name, kind | kLate)) visit(*this, value.emplace());
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
    return (kind & kLate) == 0 || place_.has(name);
  }

 private:
  static constexpr int kMost = std::numeric_limits<int>::max();

  void read(const char* name, std::string& text, unsigned kind) {
    text = (kind & kOrNull) == 0 || place_.has(name) ? place_.at(name).text() : std::string();
  }
  void read(const char* name, double& value, unsigned kind) {
    const JsonPlace place = place_.at(name);
    value = (kind & kOrNull) != 0 && !place_.has(name) ? std::nan("") : place.number();
  }
  void read(const char* name, bool& value, unsigned) { value = place_.at(name).boolean(); }
  void read(const char* name, Vec3d& value, unsigned) { value = place_.at(name).vector(); }
  void read(const char* name, int& value, unsigned) { value = place_.at(name).whole(0); }
  template <typename Count>
  void read(const char* name, Count& value, unsigned) {
    read_number(place_.at(name), value);
  }
  static void read_number(const JsonPlace& place, double& value) { value = place.number(); }
  template <typename Count>
  static void read_number(const JsonPlace& place, Count& value) {
    value = static_cast<Count>(place.count());
  }

  JsonPlace place_;
  Extent extent_;
};

}  // namespace planescope::report
