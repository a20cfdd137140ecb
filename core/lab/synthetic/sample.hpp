#pragma once

// Synthetic recordings as folders, with their ground truth beside them: the sample, and a walk past
// a kerb and boxes, up a stair, over its landing, down again and a look back, which tracks and maps
// of planes are measured on.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/lab/synthetic/scene.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/frame.hpp"

namespace planescope::lab {

struct SampleFrame {
  Frame frame;
  FrameLabels truth;
  std::string scene;  // what it shows
  // What the recording says of it:
  std::optional<Pose> T_world_camera = {};
  std::optional<double> timestamp_s = {};  // else its number
  std::optional<Vec3d> gravity = {};       // else the true one, where the folder states it
};

/// A synthetic folder recording, and what it says of itself in planescope.json.
struct SampleFolder {
  std::string made_by;  // the command
  std::uint64_t seed = 1;
  std::size_t frames = 1;  // at least one
  bool color = true;       // frames have colour images
  bool gravity = false;    // state the true gravity
};

/// Writes depth/, color/ and planescope.json, and beside it in default_label_dir(dir) the exact
/// ground truth; frames are made one after another. Overwrites an earlier sample; throws Error,
/// before anything is made or written, where `dir` holds anything else.
void write_sample_folder(const std::filesystem::path& dir,
                         const SampleFolder& folder,
                         const std::function<SampleFrame(std::size_t)>& make_frame);

/// The sample: named scenes through the camera.
struct SampleOptions {
  std::uint64_t seed = 1;
  std::vector<std::string> scenes = {"stairs", "kerb", "boxes"};  // one frame each; scene_names()
  int width = 640, height = 480;
  bool noise = true;     // false: exact depth, rounded to counts
  bool color = true;     // false: depth only
  bool gravity = false;  // also state the true gravity in planescope.json
};

/// Frame `index` of the sample, and its exact ground truth.
SampleFrame make_sample_frame(const SampleOptions& options, std::size_t index);

/// Writes a folder recording (depth/, color/, planescope.json) and, beside it in
/// default_label_dir(dir), its exact ground truth. The same options give the same pixels and the
/// same JSON bytes on every machine. Overwrites an earlier sample; throws Error, before anything is
/// written, where `dir` holds anything else, on unknown scenes and on impossible sizes.
void write_sample(const std::filesystem::path& dir, const SampleOptions& options = {});

// ---- The walk ----

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
