#pragma once

// planescope segment, also used by other commands as their last step.

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "app/commands/planes_file.hpp"

namespace planescope::app {

struct SegmentArgs {
  InputArgs input;            // one recording
  std::filesystem::path out;  // -o; empty: no files
  std::vector<std::string> also;
  std::filesystem::path map;  // --map; empty: none
  bool json = false, ros_json = false;
  bool quiet = false;  // print nothing about frames
};

/// Writes DIR/frames/000000/{planes.json,timings.json,planes.png,cloud.ply}, and tracks.png with
/// --map, for each frame, or all frames into one .mcap file. An Error leaves no output; a stop
/// keeps the finished frames and throws Cancelled. Returns the exit code. If `file` is set, frames
/// are written to it instead of -o.
int run_segment(const SegmentArgs& args, std::stop_token stop, PlanesFile* file = nullptr);

}  // namespace planescope::app
