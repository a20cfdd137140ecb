// What can stand at a place of a filter, judged by the words before it.

#include <algorithm>

#include "core/replay/filter.hpp"
#include "core/replay/filter_fields.hpp"
#include "core/replay/filter_tokens.hpp"

namespace planescope {
namespace {

/// The word that the cursor is in or behind: bytes [begin, end).
struct Place {
  std::size_t begin = 0, end = 0;
  std::string_view typed;           // of the word, up to the cursor
  std::vector<FilterToken> before;  // the words before it
};

Place place_at(std::string_view text, std::size_t cursor) {
  std::optional<FilterProblem> ignored;
  Place place{cursor, cursor, {}, filter_tokens(text.substr(0, cursor), ignored)};
  if (!place.before.empty() && place.before.back().kind == FilterToken::name &&
      place.before.back().end == cursor) {
    place.begin = place.before.back().begin;
    place.typed = text.substr(place.begin, cursor - place.begin);
    place.before.pop_back();
    for (const FilterToken& token : filter_tokens(text, ignored))
      if (token.begin == place.begin) place.end = token.end;
  }
  return place;
}

bool is_sign(const FilterToken& token) { return token.kind == FilterToken::sign; }

bool wants_value(const std::vector<FilterToken>& before) {
  return before.empty() || (is_sign(before.back()) && before.back().text != ")");
}

/// The type that the value before a word asks for, boolean where it starts a condition.
FilterType wanted_type(const std::vector<FilterToken>& before) {
  const std::size_t n = before.size();
  if (n == 0 || !is_sign(before[n - 1])) return FilterType::boolean;
  const std::string_view sign = before[n - 1].text;
  if (sign == "&&" || sign == "||" || sign == "!" || sign == "(") return FilterType::boolean;
  if (n >= 2 && is_comparison(sign) && before[n - 2].kind == FilterToken::name)
    if (const FilterField* field = find_filter_field(before[n - 2].text)) return field->type;
  return FilterType::number;
}

using Choices = std::vector<FilterName>;

Choices values_of(FilterType type) {
  Choices choices;
  for (const FilterValue& value : filter_values())
    if (value.type == type) choices.push_back({value.name, value.meaning});
  if (type != FilterType::number && type != FilterType::boolean) return choices;
  // A condition can start with any field; a number is more likely compared with a threshold.
  const auto& fields = filter_fields();
  for (const bool likely : {true, false})
    for (const FilterField& field : fields) {
      const bool threshold = field.name.starts_with("theta") || field.option != nullptr;
      if (type == FilterType::number && field.type != FilterType::number) continue;
      if ((type == FilterType::boolean || threshold) == likely)
        choices.push_back({field.name, field.meaning});
    }
  return choices;
}

Choices signs_after(const std::vector<FilterToken>& before) {
  const Choices join = {{"&&", "and"}, {"||", "or"}};
  const FilterToken& last = before.back();
  const bool compared = before.size() >= 2 && is_sign(before[before.size() - 2]) &&
                        is_comparison(before[before.size() - 2].text);
  const FilterField* field =
      last.kind == FilterToken::name ? find_filter_field(last.text) : nullptr;
  if (compared || !field || field->type == FilterType::boolean) return join;
  Choices signs = {{"==", "equal"}, {"!=", "different"}};
  if (field->type == FilterType::number)
    signs.insert(signs.begin(),
                 {{">", "greater"}, {">=", "at least"}, {"<", "less"}, {"<=", "at most"}});
  return signs;
}

bool same_letters(char a, char b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return lower(a) == lower(b);
}

bool contains(std::string_view name, std::string_view typed) {
  return std::search(name.begin(), name.end(), typed.begin(), typed.end(), same_letters) !=
         name.end();
}

bool starts_with(std::string_view name, std::string_view typed) {
  return name.size() >= typed.size() &&
         std::equal(typed.begin(), typed.end(), name.begin(), same_letters);
}

}  // namespace

std::vector<Completion> complete_filter(const std::string& text, std::size_t cursor) {
  const Place place = place_at(text, std::min(cursor, text.size()));
  const bool in_number = !place.before.empty() && place.before.back().end == cursor &&
                         place.before.back().kind == FilterToken::number;
  if (in_number) return {};
  const bool value = wants_value(place.before);
  const Choices choices = value ? values_of(wanted_type(place.before)) : signs_after(place.before);
  std::vector<Completion> completions;
  for (const bool at_start : {true, false})
    for (const FilterName& choice : choices)
      if (at_start ? starts_with(choice.name, place.typed)
                   : contains(choice.name, place.typed) && !starts_with(choice.name, place.typed))
        completions.push_back({place.begin, place.end, choice.name, choice.meaning});
  return completions;
}

}  // namespace planescope
