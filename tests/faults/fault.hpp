#pragma once

// Fault injection for tests: makes a chosen call fail, and snapshots the output folder.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "faults/kinds.hpp"

namespace planescope::faults {

/// Which call is to fail, and how.
struct Fault {
  std::string kind;
  std::uint32_t at = 1;  // the first is 1
  int error = 0;         // an errno; 0: a read or write does half of what it was asked; or kKill
  bool stays = false;    // the calls after it fail as well
};

/// Of a run below the fault layer: how many calls of each kind it made.
struct Met {
  testing_cli::Ran ran;
  std::map<std::string, std::uint32_t> calls;
};

/// False where nothing can be preloaded: with sanitizers.
bool can_preload();

/// Runs the program below the layer, which counts calls that concern files below `folder`. No
/// longer than a minute: the exit code is 142 then.
Met run_counted(const std::vector<std::string>& args, const std::filesystem::path& folder);
Met run_faulted(const std::vector<std::string>& args,
                const std::filesystem::path& folder,
                const Fault& fault);

/// What lies below a folder: each file's text without times, each folder with a '/' behind its
/// name.
using Snapshot = std::map<std::string, std::string>;
Snapshot snapshot(const std::filesystem::path& folder);

/// Without what the next run resumes or removes.
Snapshot without_unfinished_work(Snapshot files);
/// Lists files that are neither as before nor as wanted, and lost ones; empty if there are none.
std::string damage(const Snapshot& found, const Snapshot& before, const Snapshot& wanted);

/// Where two snapshots differ, a line each; empty where they do not.
std::string differences(const Snapshot& found, const Snapshot& expected);

}  // namespace planescope::faults
