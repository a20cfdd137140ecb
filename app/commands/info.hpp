#pragma once

#include "app/commands/inputs.hpp"

namespace planescope::app {

struct InfoArgs {
  InputArgs input;
  bool json = false;
};

/// Prints what is in each recording: format, device, sizes, unit, intrinsics, colour, gravity, time
/// and gaps, and what was lost. Returns the exit code.
int run_info(const InfoArgs& args);

}  // namespace planescope::app
