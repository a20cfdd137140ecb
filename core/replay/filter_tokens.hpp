#pragma once

// The filter language's words. Internal to core/replay.

#include <optional>
#include <string_view>
#include <vector>

#include "core/replay/filter.hpp"

namespace planescope {

struct FilterToken {
  enum Kind { name, number, sign } kind = sign;
  std::size_t begin = 0, end = 0;
  std::string_view text;  // of the text given
  double value = 0;       // of a number
};

/// Up to the first thing that is no word; `problem` says what that is.
std::vector<FilterToken> filter_tokens(std::string_view text,
                                       std::optional<FilterProblem>& problem);

bool is_comparison(std::string_view sign);

}  // namespace planescope
