#pragma once

// Fault injection for tests: makes a chosen call fail, and snapshots the output folder.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "faults/kinds.hpp"

namespace planescope::faults {

/// The call that fails, and how.
struct Fault {
  std::string kind;
  std::uint32_t at = 1;  // from 1
  int error = 0;         // an errno; 0: a read or write processes half of its bytes; or kKill
  bool stays = false;    // later calls fail as well
};

/// Number of calls of each kind in a run with the fault layer.
struct Met {
  testing_cli::Ran ran;
  std::map<std::string, std::uint32_t> calls;
};

/// False if nothing can be preloaded, as with sanitizers.
bool can_preload();

/// Runs the program with the fault layer, which counts calls that concern files below `folder`.
/// After a minute, the run is stopped with exit code 142.
Met run_counted(const std::vector<std::string>& args, const std::filesystem::path& folder);
Met run_faulted(const std::vector<std::string>& args,
                const std::filesystem::path& folder,
                const Fault& fault);

/// Contents of a folder: the text of each file without times, and folders with a '/' after their
/// name.
using Snapshot = std::map<std::string, std::string>;
Snapshot snapshot(const std::filesystem::path& folder);

/// Removes the files that the next run resumes or removes.
Snapshot without_unfinished_work(Snapshot files);
/// Lists files that are neither as before nor as wanted, and lost ones; empty if there are none.
std::string damage(const Snapshot& found, const Snapshot& before, const Snapshot& wanted);

/// Differences of two snapshots, one per line; empty if they are equal.
std::string differences(const Snapshot& found, const Snapshot& expected);

}  // namespace planescope::faults
