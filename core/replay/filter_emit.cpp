#include "core/replay/filter_emit.hpp"

#include <fmt/format.h>

#include <charconv>

#include "core/base/text.hpp"

namespace planescope {
namespace {

std::optional<std::int32_t> number_of_plane_name(std::string_view name) {
  if (name.size() < 2 || (name[0] != 'P' && name[0] != 'p')) return std::nullopt;
  std::int32_t number = 0;
  const char* end = name.data() + name.size();
  const auto [stopped, error] = std::from_chars(name.data() + 1, end, number);
  if (error != std::errc() || stopped != end || number < 1) return std::nullopt;
  return number;
}

std::string meant_by(std::string_view name) {
  if (name == "and") return "&&";
  if (name == "or") return "||";
  if (name == "not") return "!";
  std::vector<std::string> names;
  for (const FilterField& field : filter_fields()) names.push_back(field.name);
  for (const FilterValue& value : filter_values()) names.push_back(value.name);
  for (const std::string& known : names)  // still being typed
    if (name.size() > 1 && known.starts_with(name)) return known;
  return nearest_name(name, names);
}

bool is_identity(const FilterTerm& term) {
  return term.type == FilterType::plane || term.type == FilterType::point;
}

FilterOp::Code code_of(std::string_view sign) {
  if (sign == "==") return FilterOp::equal;
  if (sign == "!=") return FilterOp::different;
  if (sign == "<") return FilterOp::less;
  if (sign == "<=") return FilterOp::less_equal;
  if (sign == ">") return FilterOp::greater;
  return FilterOp::greater_equal;
}

}  // namespace

void fail_filter(std::size_t begin, std::size_t end, std::string message) {
  throw FilterFailed{{begin, end, std::move(message)}};
}
void fail_filter(const FilterToken& token, std::string message) {
  fail_filter(token.begin, token.end, std::move(message));
}

FilterTerm FilterEmitter::constant(const FilterToken& token, FilterType type, double value) {
  program_.push_back({.code = FilterOp::constant, .number = value});
  return {type, token.begin, token.end, value};
}

FilterTerm FilterEmitter::named(const FilterToken& token, FilterType wanted) {
  // `merge` is a stage beside `stage==`, and a kind of event elsewhere.
  if (const FilterValue* value = find_filter_value(token.text); value && value->type == wanted)
    return constant(token, value->type, value->value);
  if (const FilterField* field = find_filter_field(token.text)) {
    const FilterTerm term{field->type, token.begin, token.end};
    if (field->option)
      program_.push_back({.code = FilterOp::option, .option_info = field->option});
    else if (!is_identity(term))
      program_.push_back({.code = FilterOp::field, .value = field->value});
    return term;
  }
  if (const FilterValue* value = find_filter_value(token.text))
    return constant(token, value->type, value->value);
  if (const auto plane = number_of_plane_name(token.text))
    return constant(token, FilterType::plane_name, *plane);
  const std::string near = meant_by(token.text);
  fail_filter(token, near.empty()
                         ? fmt::format("there is no '{}'", token.text)
                         : fmt::format("there is no '{}', did you mean '{}'?", token.text, near));
}

void FilterEmitter::compare(const FilterTerm& left,
                            const FilterToken& sign,
                            const FilterTerm& right) {
  if (is_identity(left)) return compare_identity(left, sign, right);
  if (is_identity(right)) return compare_identity(right, sign, left);
  if (left.type != right.type)
    fail_filter(right.begin, right.end,
                fmt::format("'{}' is {} and cannot be compared with {}", text_of(left),
                            to_string(left.type), to_string(right.type)));
  if (left.type == FilterType::boolean)
    fail_filter(sign, fmt::format("'{}' is true or false by itself: leave out '{}', or write '!' "
                                  "before it",
                                  text_of(left), sign.text));
  if (left.type != FilterType::number) need_equality(left, sign);
  emit(code_of(sign.text));
}

/// plane==7, point!=12: among all that the event concerns.
void FilterEmitter::compare_identity(const FilterTerm& field,
                                     const FilterToken& sign,
                                     const FilterTerm& other) {
  need_equality(field, sign);
  const bool is_plane = field.type == FilterType::plane;
  const bool fits =
      other.type == FilterType::number || (is_plane && other.type == FilterType::plane_name);
  if (!fits || !other.constant)
    fail_filter(other.begin, other.end,
                fmt::format("'{}' is compared with {}, nothing else", text_of(field),
                            is_plane ? "P7 or 7" : "a number"));
  program_.pop_back();  // the constant
  const bool differs = sign.text == "!=";
  if (is_plane)  // planes count from P1
    program_.push_back({.code = FilterOp::is_plane, .number = *other.constant - 1});
  else
    program_.push_back({.code = FilterOp::is_point, .number = *other.constant});
  if (!differs) return;
  emit(FilterOp::invert);
  const std::size_t unless = jump(FilterOp::and_then);
  emit(is_plane ? FilterOp::has_plane : FilterOp::has_point);
  land(unless);
}

std::size_t FilterEmitter::jump(FilterOp::Code code) {
  emit(code);
  return program_.size() - 1;
}

void FilterEmitter::need_equality(const FilterTerm& term, const FilterToken& sign) const {
  if (sign.text != "==" && sign.text != "!=")
    fail_filter(sign, fmt::format("'{}' is {}: compare it with '==' or '!='", text_of(term),
                                  to_string(term.type)));
}

void FilterEmitter::need_number(const FilterTerm& term) const {
  if (term.type != FilterType::number)
    fail_filter(
        term.begin, term.end,
        fmt::format("'{}' is {}, a number is expected", text_of(term), to_string(term.type)));
}

void FilterEmitter::need_boolean(const FilterTerm& term) const {
  if (term.type != FilterType::boolean)
    fail_filter(
        term.begin, term.end,
        fmt::format("'{}' is {}: compare it with something", text_of(term), to_string(term.type)));
}

std::string FilterEmitter::text_of(const FilterTerm& term) const {
  return std::string(text_.substr(term.begin, term.end - term.begin));
}

}  // namespace planescope
