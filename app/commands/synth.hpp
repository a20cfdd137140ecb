#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>

#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "core/lab/synthetic/stairs.hpp"

namespace planescope::app {

struct SynthSampleArgs {
  std::filesystem::path out;  // -o
  lab::SampleOptions sample;
};

/// Writes a folder recording and its labels beside it. Returns the exit code.
int run_synth_sample(const SynthSampleArgs& args);

struct SynthStairsArgs {
  std::filesystem::path out;  // -o
  int count = 100;
  lab::StairsOptions stairs;
  int threads = 1;
};

/// Writes the paper's evaluation set: DIR/stairs_000.ply and so on, with label and instance.
int run_synth_stairs(const SynthStairsArgs& args, std::stop_token stop);

struct SynthSetArgs {
  std::filesystem::path out;  // -o
  lab::EvaluationSet set;
  int count = 0;
  lab::EvaluationOptions options;
  int threads = 1;  // clouds
};

/// Writes frames of an evaluation set: clouds as synth stairs does, depth as synth sample does.
int run_synth_set(const SynthSetArgs& args, std::stop_token stop);

}  // namespace planescope::app
