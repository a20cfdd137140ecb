#pragma once

#include <filesystem>
#include <stop_token>

#include "app/commands/inputs.hpp"

namespace planescope::app {

struct SegmentArgs {
  InputArgs input;            // one recording
  std::filesystem::path out;  // -o
  bool json = false;
};

/// Writes DIR/frames/000000/{planes.json,timings.json,planes.png,cloud.ply} for each frame. All or
/// nothing on an Error; the frames done so far, and Cancelled, on a stop. Returns the exit code.
int run_segment(const SegmentArgs& args, std::stop_token stop);

}  // namespace planescope::app
