#pragma once

// Runs the built programs in tests: exit code, output, signals and scratch folders.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "support/has.hpp"

namespace planescope::testing_cli {

using planescope::has;

/// What a run of the program left behind.
struct Ran {
  int code = -1;  // exit code, or 128 + the signal's number
  std::string out;
  std::string err;
  long peak_kb = 0;  // of resident memory
};

/// Runs `planescope ARGS...` with no terminal and waits for it; or `planescope-lab ...` where that
/// is the first of them. `before`: is called in the process that becomes the program, to change its
/// environment, limits or user.
Ran run(const std::vector<std::string>& args, const std::function<void()>& before = {});

/// Starts it, sends `signal_number` as soon as `marker` exists, and waits for the end.
Ran run_and_signal(const std::vector<std::string>& args,
                   int signal_number,
                   const std::filesystem::path& marker);

/// As run(), and calls `then` as soon as `marker` exists.
Ran run_and_then(const std::vector<std::string>& args,
                 const std::filesystem::path& marker,
                 const std::function<void()>& then);

/// Runs scripts/typeset with these words and returns what it prints.
std::string typeset(const std::string& words);

/// A variable of the environment while this object lives.
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

/// What ended with exit code 0.
Ran well(Ran ran);
/// That it ended with exit code 2 and one line on stderr, which holds `part`.
void expect_refused(const Ran& ran, const std::string& part = "");

/// True if `err` is exactly one line that begins with the program's name.
bool is_one_line(const std::string& err);

}  // namespace planescope::testing_cli
