#pragma once

// How long whole frames of a recording take, as in the paper's table IV.

#include <functional>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// Medians over runs of frames.
struct FrameRow {
  std::string recording, classifier;  // for the tables, left to the caller
  int threads = 1;
  int frames = 0, runs = 0;  // different frames, and how often one was run
  double points = 0;         // measured, within range or not
  double voxels = 0, planes = 0;
  planes::FrameTimings ms;
  double fps = 0;        // as the paper's: of t_d + t_c + t_b + t_s; 0 if nothing is within range
  double whole_fps = 0;  // of these, back-projection and cropping; not of loading
};

/// Up to `runs` of `frames`, evenly spread; where there are fewer, each is run several times. Some
/// warm-up runs do not count. Frames are loaded anew for each run. `options.threads` as given.
/// Throws Error where a frame cannot be read or has no gravity. `progress` is called before each
/// run with its number and that of all; it may be empty and may throw to stop.
FrameRow measure_frames(const io::Recording& recording,
                        const std::vector<int>& frames,
                        const planes::PipelineOptions& options,
                        const planes::Classifier& classifier,
                        const std::function<void(int, int)>& progress = {},
                        int runs = 30);

}  // namespace planescope::lab
