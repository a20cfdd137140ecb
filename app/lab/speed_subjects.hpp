#pragma once

// What `planescope-lab bench speed` is measured on.

#include <memory>
#include <vector>

#include "app/commands/inputs.hpp"
#include "core/lab/bench/chain_speed.hpp"

namespace planescope::app {

/// A recording that is open for as long as its frames are read again.
struct OpenSubject {
  OpenInput input;
  std::vector<int> numbers;  // of the subject's frames in the recording
  lab::SpeedSubject subject;
};

/// Ten of its frames at most, evenly spread. Throws Error where none of these can be read, knows or
/// tells which way is down, and has anything within range.
std::shared_ptr<OpenSubject> read_subject(OpenInput input, const planes::PipelineOptions& options);

/// What is measured where no recording is given, depth_stairs with a camera's errors: the same
/// bytes everywhere.
std::shared_ptr<OpenSubject> made_subject(const planes::PipelineOptions& options);

}  // namespace planescope::app
