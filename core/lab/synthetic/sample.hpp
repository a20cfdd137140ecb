#pragma once

// Synthetic recordings as folders, with their ground truth beside them: the sample, and a walk for
// measuring tracks and maps of planes. The walk passes a kerb and boxes, goes up stairs, over a
// landing and down again, and looks back.

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
  std::string scene;  // name of the scene
  // Data stored in the recording:
  std::optional<Pose> T_world_camera = {};
  std::optional<double> timestamp_s = {};  // else the frame number
  std::optional<Vec3d> gravity = {};       // else the true one, if the folder includes it
};

/// A synthetic folder recording, and its facts in planescope.json.
struct SampleFolder {
  std::string made_by;  // the command
  std::uint64_t seed = 1;
  std::size_t frames = 1;  // at least one
  bool color = true;       // frames have color images
  bool gravity = false;    // include the true gravity
};

/// Writes depth/, color/ and planescope.json, and the exact ground truth beside it in
/// default_label_dir(dir); generates frames one after another. Overwrites an earlier sample; throws
/// Error, before generating or writing anything, if `dir` contains anything else.
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
  bool gravity = false;  // include the true gravity in planescope.json
};

/// Frame `index` of the sample, and its exact ground truth.
SampleFrame make_sample_frame(const SampleOptions& options, std::size_t index);

/// Writes a folder recording (depth/, color/, planescope.json) and, beside it in
/// default_label_dir(dir), its exact ground truth. The same options give the same pixels and the
/// same JSON bytes on every machine. Overwrites an earlier sample; throws Error, before writing
/// anything, if `dir` contains anything else, and for unknown scenes or invalid sizes.
void write_sample(const std::filesystem::path& dir, const SampleOptions& options = {});

// ---- The walk ----

struct SequenceOptions {
  std::uint64_t seed = 1;
  int frames = 300;  // always the whole walk of about 20 s
  double rate_hz = 15;
  int width = 640, height = 480;
  bool noise = true, color = true;
  bool imu = true;       // each frame has gravity from an accelerometer
  bool covered = false;  // ten frames in the middle measure nothing
  bool moved = false;    // a box is removed later
};

struct Sequence {
  Scene scene;
  Scene later;  // from frame `change` on
  std::size_t change = 0;
  std::vector<CameraPose> cameras;

  const Scene& scene_of(std::size_t frame) const { return frame < change ? scene : later; }
};

/// Throws Error for invalid sizes. Plane ids are the same in all frames.
Sequence make_sequence(const SequenceOptions& options);
/// Frame `index` with its exact truth and pose; depends only on its arguments.
SampleFrame make_sequence_frame(const SequenceOptions& options,
                                const Sequence& sequence,
                                std::size_t index);

/// Writes a folder like write_sample(), with poses. `progress` may throw.
void write_sequence(const std::filesystem::path& dir,
                    const SequenceOptions& options,
                    int threads,
                    const std::function<void(int done, int all)>& progress = {});

}  // namespace planescope::lab
