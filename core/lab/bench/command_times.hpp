#pragma once

// How long whole programs take, from their start to their end.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/lab/bench/measuring.hpp"

namespace planescope::lab {

struct TimedCommand {
  std::string name;               // in the tables
  std::vector<std::string> args;  // the program's path first
};

struct CommandRow {
  std::string name;
  Times wall_ms = {}, cpu_ms = {};
  double peak_mib = 0;  // resident, of one run
};

/// Each command once in every round, in turn. What they print is dropped. Throws Error where one
/// cannot be started or fails. `before`: as in interleaved_ms().
std::vector<CommandRow> measure_commands(std::span<const TimedCommand> commands,
                                         int rounds,
                                         const std::function<void()>& before);

}  // namespace planescope::lab
