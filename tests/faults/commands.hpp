#pragma once

// Main commands as fault tests run them, each in a folder of its own.

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

/// A command that is run in a folder of its own, which it finds as an earlier run left it.
struct Command {
  std::string name;
  std::function<void(const std::filesystem::path&)> prepare;  // makes the folder's files
  std::function<Words(const std::filesystem::path&)> words;   // of the run that meets a fault
  std::vector<std::string> few = {};  // kinds of calls that fail in the suite; empty: all
  /// Beginnings of names: files that may be of a state in between after a run that failed.
  std::vector<std::string> varies = {};
  /// The file with a window's picture, which shows what the window could not do.
  std::string window = "";
};

inline void PrintTo(const Command& command, std::ostream* out) { *out << command.name; }

/// The main commands, on a recording of two frames of 160x120.
std::vector<Command> main_commands();

/// The one of that name.
Command main_command(const std::string& name);

}  // namespace planescope::faults
