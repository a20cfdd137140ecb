#pragma once

// planescope segment, for commands that end with it.

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "app/commands/planes_file.hpp"

namespace planescope::app {

struct SegmentArgs {
  InputArgs input;            // one recording
  std::filesystem::path out;  // -o; empty: nothing is written
  std::vector<std::string> also;
  std::filesystem::path map;  // --map; empty: none
  bool json = false, ros_json = false;
  bool quiet = false;  // prints nothing about frames
};

/// Writes DIR/frames/000000/{planes.json,timings.json,planes.png,cloud.ply}, with --map tracks.png,
/// for each frame, or all frames into one .mcap. All or nothing on an Error; the frames done so
/// far, and Cancelled, on a stop. Returns the exit code. `file`: takes the frames instead of -o.
int run_segment(const SegmentArgs& args, std::stop_token stop, PlanesFile* file = nullptr);

}  // namespace planescope::app
