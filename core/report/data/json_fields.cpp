#include "core/report/data/json_fields.hpp"

#include <nlohmann/json.hpp>

#include "core/model/json.hpp"

namespace planescope::report {

namespace {
using Json = nlohmann::ordered_json;
}

void FieldWriter::operator()(const char* name, const std::string& text, unsigned kind) {
  json_[name] = (kind & kOrNull) != 0 && text.empty() ? Json() : Json(text);
}
void FieldWriter::operator()(const char* name, double value, unsigned kind) {
  json_[name] =
      (kind & kRounded) != 0 ? rounded(value) : value;  // NaN and infinity are written as null
}
void FieldWriter::operator()(const char* name, bool value, unsigned) { json_[name] = value; }
void FieldWriter::operator()(const char* name, int value, unsigned) { json_[name] = value; }
void FieldWriter::operator()(const char* name, std::uint32_t value, unsigned) {
  json_[name] = value;
}
void FieldWriter::operator()(const char* name, std::uint64_t value, unsigned) {
  json_[name] = value;
}
void FieldWriter::operator()(const char* name, const Vec3d& value, unsigned) {
  json_[name] = vector_json(value);
}

void FieldWriter::null(const char* name) { json_[name] = nullptr; }

FieldWriter FieldWriter::begin_object(const char* name) {
  return FieldWriter(json_[name] = Json::object());
}
void FieldWriter::begin_list(const char* name) { json_[name] = Json::array(); }
void FieldWriter::append(const char* name, double value) { json_[name].push_back(value); }
void FieldWriter::append(const char* name, std::uint32_t value) { json_[name].push_back(value); }
FieldWriter FieldWriter::append_object(const char* name) {
  return FieldWriter(json_[name].emplace_back(Json::object()));
}

}  // namespace planescope::report
