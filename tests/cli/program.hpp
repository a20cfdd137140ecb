#pragma once

// Runs the built programs in tests: exit code, output, signals and scratch folders.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "support/has.hpp"

namespace planescope::testing_cli {

using planescope::has;

/// Result of a program run.
struct Ran {
  int code = -1;  // exit code, or 128 + the signal's number
  std::string out;
  std::string err;
  long peak_kb = 0;  // of resident memory
};

/// Runs `planescope ARGS...` without a terminal and waits for it; `planescope-lab` if that is the
/// first argument. `before` is called in the child process, to change its environment, limits or
/// user.
Ran run(const std::vector<std::string>& args, const std::function<void()>& before = {});

/// Starts the program, sends `signal_number` as soon as `marker` exists, and waits for the end.
Ran run_and_signal(const std::vector<std::string>& args,
                   int signal_number,
                   const std::filesystem::path& marker);

/// Like run(), but calls `then` as soon as `marker` exists.
Ran run_and_then(const std::vector<std::string>& args,
                 const std::filesystem::path& marker,
                 const std::function<void()>& then);

/// Runs scripts/typeset with these arguments and returns its output.
std::string typeset(const std::string& words);

/// Sets an environment variable for the lifetime of this object.
struct Environment {
  Environment(const char* variable, const std::string& value);
  ~Environment();
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  const char* name;
};

/// A new, empty folder for the running test.
std::filesystem::path scratch();

std::string read_text(const std::filesystem::path& path);

/// All files below `dir`, relative, sorted.
std::vector<std::string> files_below(const std::filesystem::path& dir);

/// Expects exit code 0.
Ran well(Ran ran);
/// Expects exit code 2 and one line on stderr that contains `part`.
void expect_refused(const Ran& ran, const std::string& part = "");

/// Whether `err` is exactly one line that begins with the program's name.
bool is_one_line(const std::string& err);

}  // namespace planescope::testing_cli
