#pragma once

// Lists of recordings: lines of words, with options as they would be typed.

#include <filesystem>
#include <functional>
#include <span>
#include <sstream>
#include <string>

#include "app/commands/inputs.hpp"

namespace planescope::app {

/// Calls read(words) for each line that is not empty and no comment. Throws Error naming the list
/// and the line where that throws one.
void read_list(const std::filesystem::path& list,
               const std::function<void(std::istringstream& words)>& read);

/// The rest of a line: options as they would be typed, of those that are `known`. Throws Error.
void set_listed_options(InputArgs& args,
                        std::istringstream& words,
                        std::span<const std::string> known);

}  // namespace planescope::app
