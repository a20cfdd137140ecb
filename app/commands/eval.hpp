#pragma once

#include <stop_token>

#include "app/commands/inputs.hpp"

namespace planescope::app {

struct EvalArgs {
  InputArgs input;
  std::filesystem::path prediction;  // scored in place of our own segmentation; empty: none
  bool json = false;
};

/// Prints the metrics of each frame that has ground truth, and their mean. Throws Error if none
/// has, or the predictions lack one of them. Returns the exit code.
int run_eval(const EvalArgs& args, std::stop_token stop);

}  // namespace planescope::app
