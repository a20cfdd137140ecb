#pragma once

// How the threads of a run are shared out.

#include <algorithm>

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// Frames side by side and, if there are fewer frames than threads, several threads for each.
struct FrameThreads {
  int at_once = 1;
  PipelineOptions pipeline;  // of one frame
};

inline FrameThreads threads_for_frames(const PipelineOptions& options, int frames) {
  FrameThreads threads{std::clamp(options.threads, 1, std::max(1, frames)), options};
  threads.pipeline.threads = std::max(1, options.threads / threads.at_once);
  return threads;
}

}  // namespace planescope::planes
