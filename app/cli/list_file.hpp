#pragma once

// Lists of recordings: lines of words, with options as they would be typed.

#include <filesystem>
#include <functional>
#include <span>
#include <sstream>
#include <string>

#include "app/cli/typed.hpp"

namespace planescope::app {

/// Calls read(words) for each line that is not empty and no comment. Throws Error naming the list
/// and the line where that throws one.
void read_list(const std::filesystem::path& list,
               const std::function<void(std::istringstream& words)>& read);

/// The rest of a line as if it had been typed, of the options `known` alone, which are among
/// --frames, --gravity, --intrinsics, --depth-unit and --max-range. Throws Error.
Typed typed_options(std::istringstream& words, std::span<const std::string> known);

}  // namespace planescope::app
