#pragma once

// Main commands for fault tests, each run in its own folder.

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace planescope::faults {

using Words = std::vector<std::string>;

inline Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// A command that runs in its own folder, in the state left by an earlier run.
struct Command {
  std::string name;
  std::function<void(const std::filesystem::path&)> prepare;  // creates the folder's files
  std::function<Words(const std::filesystem::path&)> words;   // arguments of the run with the fault
  std::vector<std::string> few = {};  // kinds of calls that fail in the suite; empty: all
  /// Prefixes of files that may be in an intermediate state after a failed run.
  std::vector<std::string> varies = {};
  /// The file with the window's picture, which displays failures.
  std::string window = "";
};

inline void PrintTo(const Command& command, std::ostream* out) { *out << command.name; }

/// The main commands, on a recording with two frames of 160x120.
std::vector<Command> main_commands();

/// The command with this name.
Command main_command(const std::string& name);

}  // namespace planescope::faults
