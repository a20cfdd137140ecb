#pragma once

#include <optional>
#include <string_view>

#include "core/replay/filter.hpp"
#include "core/replay/filter_program.hpp"

namespace planescope {

/// docs/filter.md has the grammar. Internal to core/replay.
std::optional<FilterProgram> parse_filter(std::string_view text, FilterProblem& problem);

}  // namespace planescope
