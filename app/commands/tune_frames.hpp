#pragma once

// The labelled frames that `planescope tune` searches on, and those that it holds out.

#include <filesystem>
#include <vector>

#include "app/commands/inputs.hpp"
#include "core/lab/tuning/tuning_trials.hpp"

namespace planescope::app {

struct TuneArgs {
  InputArgs input;
  std::filesystem::path list;        // --list; empty: the recordings of `input`
  std::filesystem::path out;         // -o
  std::vector<std::string> options;  // --only; empty: all that are tunable
  int hold_out = 2;                  // every so many-th labelled frame is held out
  int trials = 1000;
  double time_s = 0;  // 0: no limit
  bool json = false;
};

struct TuneFrames {
  std::vector<lab::TuningFrame> tuning, held;
};

/// Every frame of the recordings that has ground truth. Throws Error where one half has none.
TuneFrames read_tune_frames(const TuneArgs& args);

}  // namespace planescope::app
