#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>

#include "core/synthetic/stairs.hpp"

namespace planescope {

struct SynthStairsArgs {
  std::filesystem::path out;  // -o
  int count = 100;
  StairsOptions stairs;
  int threads = 1;
};

/// Writes the paper's evaluation set: DIR/stairs_000.ply and so on, with label and instance.
int run_synth_stairs(const SynthStairsArgs& args, std::stop_token stop);

}  // namespace planescope
