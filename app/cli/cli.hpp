#pragma once

#include <functional>
#include <stop_token>
#include <string>

namespace planescope::app {

/// A command with its arguments, ready to run; returns the exit code.
using Job = std::function<int(std::stop_token)>;

/// Reads the command line. `--help` and `--version` become jobs that print. Throws Error with one
/// line on anything that is not understood.
Job parse_command_line(int argc, char** argv);

}  // namespace planescope::app
