#pragma once

// A walk: past a kerb and boxes, up a stair, over its landing, down again and a look back. What
// tracks and maps of planes are measured on.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/lab/synthetic/sample.hpp"
#include "core/lab/synthetic/scene.hpp"

namespace planescope::lab {

struct SequenceOptions {
  std::uint64_t seed = 1;
  int frames = 300;  // the whole walk, of some 20 s, whatever their number
  double rate_hz = 15;
  int width = 640, height = 480;
  bool noise = true, color = true;
  bool imu = true;       // each frame states gravity as an accelerometer tells it
  bool covered = false;  // ten frames in the middle measure nothing
  bool moved = false;    // a box is gone in the second half
};

struct Sequence {
  Scene scene;
  Scene later;  // from frame `change` on
  std::size_t change = 0;
  std::vector<CameraPose> cameras;

  const Scene& scene_of(std::size_t frame) const { return frame < change ? scene : later; }
};

/// Throws Error on impossible sizes. Plane ids are the same in all frames.
Sequence make_sequence(const SequenceOptions& options);
/// Frame `index` with its exact truth and pose; depends on nothing but its arguments.
SampleFrame make_sequence_frame(const SequenceOptions& options,
                                const Sequence& sequence,
                                std::size_t index);

/// A folder as write_sample() writes it, with poses. `progress` may throw.
void write_sequence(const std::filesystem::path& dir,
                    const SequenceOptions& options,
                    int threads,
                    const std::function<void(int done, int all)>& progress = {});

}  // namespace planescope::lab
