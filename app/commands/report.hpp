#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "app/commands/report_frames.hpp"

namespace planescope::app {

/// What a report is held to.
struct ReportGuardArgs {
  std::filesystem::path baseline;  // an earlier report.json; empty: none
  std::filesystem::path rules;  // planescope.rules.json; empty: with a baseline, the built-in ones
  bool approve = false;         // the report becomes the baseline
};

struct ReportArgs {
  InputArgs input;
  std::filesystem::path out;  // -o
  bool json = false;          // --json: print the path and the totals as JSON on stdout
  bool init = false;          // write the built-in rules and no report
  std::string command;        // as it was typed, without what changes no frame
  ReportGuardArgs guard;
  Shard shard;          // which part of the frames
  bool resume = false;  // frames that an earlier run finished are taken as they are
  bool pictures = true;
  bool tracks = false;  // planes are followed over the frames of each recording
};

/// Writes the report, or with `init` the rules. Returns the exit code: 0; 1 where a rule of level
/// error is broken and nothing was approved; 2 where a frame could not be read, the others being in
/// the report; 3 where rendering failed and the data files were still written. Throws Error on bad
/// input, Cancelled (after a valid partial report) on stop.
int run_report(const ReportArgs& args,
               std::stop_token stop,
               const FrameRunner& runner = run_report_frame);

}  // namespace planescope::app
