#pragma once

// From a filter's text to its words, and to a formula over events. Internal to core/debug/filter.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/debug/filter/filter.hpp"
#include "core/debug/filter/filter_fields.hpp"

namespace planescope::debug {

struct FilterPlace {
  std::size_t begin = 0, end = 0;  // bytes of the text
};
/// Throws a FilterProblem.
[[noreturn]] void fail_filter(const FilterPlace& place, std::string message);

struct FilterToken : FilterPlace {
  enum Kind { name, number, sign } kind = sign;
  std::string_view text;  // of the text given
  double value = 0;       // of a number
};
/// Up to the first thing that is no word; `problem` says what that is.
std::vector<FilterToken> filter_tokens(std::string_view text,
                                       std::optional<FilterProblem>& problem);
bool is_comparison(std::string_view sign);

/// True is 1, false 0.
using FilterFormula = std::function<double(const EventView&)>;

struct ParsedFilter {
  FilterFormula formula;
  std::vector<const planes::OptionInfo*> options;  // EventView::options are their numbers
  std::vector<double> points;                      // EventView::points are their tracks
};
/// docs/filter.md has the grammar. Throws a FilterProblem.
ParsedFilter parse_filter(std::string_view text);

}  // namespace planescope::debug
