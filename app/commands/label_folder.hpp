#pragma once

// Folders of labels as the commands are given them.

#include <filesystem>
#include <memory>
#include <vector>

#include "app/commands/labels.hpp"
#include "core/io/recording.hpp"

namespace planescope::app {

struct LabelFolder {
  std::filesystem::path dir;
  std::vector<int> frames;  // with any label file; ascending, at least one
};
/// Throws Error where the folder is none or has no labels.
LabelFolder list_labels(const std::filesystem::path& dir);

/// A folder of labels, and what they were drawn on where that can be found.
struct LabelledRecording {
  LabelFolder labels;
  std::filesystem::path path;
  std::unique_ptr<io::Recording> recording;  // null: not found
};
/// What was typed is a recording, or a folder of labels.
LabelledRecording open_labels(const LabelsArgs& args);

/// The labels of a frame that the recording has. Throws Error where they are damaged or of another
/// depth image.
FrameLabels read_labels_of(const LabelledRecording& source, int frame);

}  // namespace planescope::app
