#pragma once

// Entry point of planescope and planescope-lab: runs the command and returns the exit code.

#include <vector>

#include "app/cli/command.hpp"

namespace planescope::app {

struct Program {
  const char* name;
  const char* about;
  /// Adds its commands to the command line, in the order of --help.
  std::vector<void (*)(CLI::App& app, Line& line)> commands;
  const char* alone = nullptr;  // the default command
};

/// Runs the command line. The only place where errors become a line on stderr and an exit code: 0
/// success, 1 a threshold or comparison failed, 2 bad input or usage, 3 no display or rendering
/// failed (data files are still written), 130 canceled. The first SIGINT or SIGTERM asks the
/// command to stop; the second ends the program.
int run_program(const Program& program, int argc, char** argv);

/// Wraps help texts at 80 columns.
std::shared_ptr<CLI::FormatterBase> help_format();

/// Adds `help`, which prints the help of a command, `man`, which prints the manual of the whole
/// program as roff, and `completions`, which prints a completion script for bash, zsh or fish.
void define_help(CLI::App& app, Line& line);
void define_man(CLI::App& app, Line& line);
void define_completions(CLI::App& app, Line& line);

}  // namespace planescope::app
