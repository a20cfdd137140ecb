#pragma once

#include <filesystem>
#include <stop_token>

#include "app/commands/view.hpp"

namespace planescope::app {

struct BenchDesktopArgs {
  ViewArgs view;              // recording, options, size of the window
  int steps = 500;            // of the scrub
  std::filesystem::path out;  // desktop.json is written there; empty: nowhere
  bool json = false;
};

/// How long the window takes to show a step, off-screen, against an empty one in the same run.
int run_bench_desktop(const BenchDesktopArgs& args, std::stop_token stop);

}  // namespace planescope::app
