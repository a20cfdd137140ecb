#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/labels/model/label_files.hpp"
#include "core/model/frame.hpp"

namespace planescope::lab {

struct SampleFrame {
  Frame frame;
  FrameLabels truth;
  std::string scene;  // what it shows
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

}  // namespace planescope::lab
