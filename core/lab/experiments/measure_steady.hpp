#pragma once

// Measures how steady methods are: frames of a recording against themselves after a change that
// means nothing, and against the next frame.

#include <functional>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/lab/experiments/steady_results.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::lab {

/// By frame of the recording; empty where it has no poses at all.
using FramePoses = std::vector<std::optional<world::CameraPose>>;

/// The recording's own poses.
FramePoses own_poses(const io::Recording& recording);

/// A method with its options; `name` as tables show it.
struct SteadyMethod {
  std::string name;
  planes::PipelineOptions options;
};

struct SteadyJob {
  const io::Recording* recording = nullptr;
  std::string name;         // of the recording, for tables
  std::vector<int> frames;  // to measure; each with the recording's next one
  std::vector<SteadyMethod> methods;
  const planes::Classifier* classifier = nullptr;  // of our methods
  std::set<SteadyPart> parts;
  FramePoses poses;
  int turns = 20;   // of gravity, for each frame
  int threads = 1;  // frames and methods side by side
  std::function<void(int done, int all)> progress = {};
  std::stop_token stop = {};
};

/// The same for any number of threads. Frames on which a method cannot work are left out and
/// listed. Throws Error if the recording is not of depth images, a frame cannot be read, or no
/// frame can be worked on; Cancelled on stop.
SteadyScores measure_steady(const SteadyJob& job);

// The changes, for tests.

/// Turns a unit vector by `angle_deg` about an axis perpendicular to it, `around_deg` about itself.
Vec3d turned(const Vec3d& direction, double angle_deg, double around_deg);
/// fx, fy, cx, cy to six significant digits.
Intrinsics rounded_to_six_digits(const Intrinsics& intrinsics);
/// Moves 5 % of the valid pixels one depth count up or down.
void dither(Image16& depth, std::uint64_t seed);

}  // namespace planescope::lab
