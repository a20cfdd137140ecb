#pragma once

#include <filesystem>
#include <stop_token>
#include <string>

#include "app/commands/inputs.hpp"

namespace planescope {

struct ReportArgs {
  InputArgs input;
  std::filesystem::path out;  // -o
  bool json = false;          // --json: print the path and the totals as JSON on stdout
  std::string command;        // the command line as it was typed, for the record
};

/// Writes the report. Returns the exit code: 0, or 3 where rendering failed and the data files
/// were still written. Throws Error on bad input, Cancelled (after a valid partial report) on stop.
int run_report(const ReportArgs& args, std::stop_token stop);

}  // namespace planescope
