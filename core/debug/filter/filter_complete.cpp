// What can stand at a place of a filter, judged by the words before it.

#include <algorithm>

#include "core/debug/filter/filter_parse.hpp"

namespace planescope::debug {
namespace {

using Tokens = std::vector<FilterToken>;
using Choices = std::vector<FilterName>;

/// The type of the field that the word names, if it does.
std::optional<FilterType> field_type(const FilterToken& token) {
  const FilterSymbol* symbol = find_filter_symbol(token.text);
  return symbol && !symbol->value ? std::optional(symbol->type) : std::nullopt;
}

/// The type that the value behind these words should have, boolean where it starts a condition.
FilterType wanted_type(const Tokens& before) {
  if (before.empty()) return FilterType::boolean;
  const std::string_view sign = before.back().text;
  if (sign == "&&" || sign == "||" || sign == "!" || sign == "(") return FilterType::boolean;
  if (before.size() < 2 || !is_comparison(sign)) return FilterType::number;
  return field_type(before[before.size() - 2]).value_or(FilterType::number);
}

/// Fields where a condition starts or a number is wanted, values where another type is.
Choices values_of(FilterType type) {
  const bool of_fields = type == FilterType::boolean || type == FilterType::number;
  Choices likely, others;
  for (const FilterSymbol& symbol : filter_symbols()) {
    if (symbol.value.has_value() == of_fields) continue;
    if (symbol.type != type && type != FilterType::boolean) continue;
    // A number is most likely compared with a threshold.
    const bool is_likely =
        type != FilterType::number || symbol.option || symbol.name.starts_with("theta");
    (is_likely ? likely : others).push_back({symbol.name, symbol.meaning});
  }
  likely.insert(likely.end(), others.begin(), others.end());
  return likely;
}

Choices signs_after(const Tokens& before) {
  const bool compared = before.size() >= 2 && is_comparison(before[before.size() - 2].text);
  const std::optional<FilterType> type = field_type(before.back());
  if (compared || !type || type == FilterType::boolean) return {{"&&", "and"}, {"||", "or"}};
  Choices signs = {{"==", "equal"}, {"!=", "different"}};
  if (type == FilterType::number)
    signs.insert(signs.begin(),
                 {{">", "greater"}, {">=", "at least"}, {"<", "less"}, {"<=", "at most"}});
  return signs;
}

/// Where the letters, of either case, begin in the name; its size where they do not stand there.
std::size_t find_letters(std::string_view name, std::string_view letters) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::ranges::search(name, letters, {}, lower, lower).begin() - name.begin();
}

}  // namespace

std::vector<Completion> complete_filter(const std::string& text, std::size_t cursor) {
  const std::string_view whole = text;
  const std::size_t at = std::min(cursor, text.size());
  std::optional<FilterProblem> ignored;
  Tokens before = filter_tokens(whole.substr(0, at), ignored);
  FilterPlace word{at, at};  // that the cursor is in or behind
  if (!before.empty() && before.back().kind == FilterToken::number && before.back().end == cursor)
    return {};
  if (!before.empty() && before.back().kind == FilterToken::name && before.back().end == at) {
    word.begin = before.back().begin;
    word.end = word.begin + filter_tokens(whole.substr(word.begin), ignored).front().end;
    before.pop_back();
  }
  const std::string_view typed = whole.substr(word.begin, at - word.begin);
  const bool wants_value =
      before.empty() || (before.back().kind == FilterToken::sign && before.back().text != ")");
  const Choices choices = wants_value ? values_of(wanted_type(before)) : signs_after(before);
  std::vector<Completion> completions;
  for (const bool at_start : {true, false})
    for (const FilterName& choice : choices) {
      const std::size_t found = find_letters(choice.name, typed);
      if (found < choice.name.size() && (found == 0) == at_start)
        completions.push_back({word.begin, word.end, choice.name, choice.meaning});
    }
  return completions;
}

}  // namespace planescope::debug
