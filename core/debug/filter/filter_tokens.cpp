#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/debug/filter/filter_parse.hpp"

namespace planescope::debug {
namespace {

/// Of two that begin alike, the longer one first.
constexpr std::string_view kSigns[] = {"||", "&&", "==", "!=", "<=", ">=", "!", "<",
                                       ">",  "+",  "-",  "*",  "/",  "(",  ")"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Letters, and what UTF-8 writes the paper's symbols with.
bool starts_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

std::size_t name_length(std::string_view text) {
  const auto continues_name = [](char c) { return starts_name(c) || is_digit(c) || c == '.'; };
  return std::find_if_not(text.begin(), text.end(), continues_name) - text.begin();
}

/// The word at `at`, which is no space.
FilterToken token_at(std::string_view text, std::size_t at) {
  const std::string_view rest = text.substr(at);
  const auto token = [&](FilterToken::Kind kind, std::size_t length, double value = 0) {
    return FilterToken{{at, at + length}, kind, rest.substr(0, length), value};
  };
  const char c = rest[0];
  if (starts_name(c)) return token(FilterToken::name, name_length(rest));

  if (is_digit(c) || (c == '.' && rest.size() > 1 && is_digit(rest[1]))) {
    double value = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    const FilterToken number = token(FilterToken::number, end - rest.data(), value);
    if (error == std::errc::result_out_of_range) fail_filter(number, "a number out of range");
    const std::size_t unit = name_length(rest.substr(number.text.size()));
    if (unit == 0) return number;
    const FilterToken whole = token(FilterToken::number, number.text.size() + unit);
    fail_filter(whole,
                fmt::format("'{}' is no number: write it without a unit, in m or deg", whole.text));
  }

  for (const std::string_view sign : kSigns)
    if (rest.starts_with(sign)) return token(FilterToken::sign, sign.size());
  const FilterToken wrong = token(FilterToken::sign, 1);
  if (c == '=' || c == '&' || c == '|')
    fail_filter(wrong, fmt::format("did you mean '{0}{0}'?", c));
  const bool printable = c > ' ' && c < 0x7f;
  fail_filter(wrong,
              printable ? fmt::format("'{}' has no meaning here", c) : "a control character");
}

}  // namespace

std::vector<FilterToken> filter_tokens(std::string_view text,
                                       std::optional<FilterProblem>& problem) {
  const auto next_from = [&](std::size_t at) { return text.find_first_not_of(" \t\n\r", at); };
  std::vector<FilterToken> tokens;
  try {
    for (std::size_t at = next_from(0); at < text.size(); at = next_from(tokens.back().end))
      tokens.push_back(token_at(text, at));
  } catch (FilterProblem& found) {
    problem = std::move(found);
  }
  return tokens;
}

void fail_filter(const FilterPlace& place, std::string message) {
  throw FilterProblem{place.begin, place.end, std::move(message)};
}

}  // namespace planescope::debug
