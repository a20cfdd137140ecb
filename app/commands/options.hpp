#pragma once

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::app {

struct OptionsArgs {
  planes::PipelineOptions pipeline;  // the values to show
  bool json = false;
};

/// Prints every option that --set takes, with its unit, value and meaning. Returns the exit code.
int run_options(const OptionsArgs& args);

}  // namespace planescope::app
