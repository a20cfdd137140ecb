#pragma once

// A program's own description of its commands, from the table that parses them: for man and for
// shells.

#include "app/cli/command.hpp"

namespace planescope::app {

/// Adds `man`, which prints the manual of the whole program as roff, and `completions`, which
/// prints what bash, zsh or fish complete.
void define_man(CLI::App& app, Line& line);
void define_completions(CLI::App& app, Line& line);

}  // namespace planescope::app
