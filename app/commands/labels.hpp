#pragma once

// What the commands of planescope labels share: their options, and folders of labels as they are
// given.

#include <filesystem>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/commands.hpp"
#include "core/io/recording.hpp"

namespace planescope::app {

struct LabelsArgs {
  InputArgs input;  // recordings or folders of labels, --frames, --labels, --gravity, --voxel
  std::filesystem::path recording;  // --recording; empty: the one that the labels are named after
  std::string format;
  std::filesystem::path from, out;
  bool strict = false;  // hints count as findings
  bool json = false;
};

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
  std::map<int, int> frame_of;               // of the recording, by number of its label files

  /// The number itself if nothing is known.
  int frame(int number) const {
    const auto at = frame_of.find(number);
    return at == frame_of.end() ? number : at->second;
  }
};
/// Opens what was typed: a recording or a folder of labels.
LabelledRecording open_labels(const LabelsArgs& args);

/// The label files of this number. Throws Error where they are damaged or of another
/// depth image.
FrameLabels read_labels_of(const LabelledRecording& source, int number);
/// The frame; where its depth unit is only assumed or its camera not known, those of the labels
/// hold.
Frame frame_as_drawn(Frame frame, const io::RecordingInfo& info, const FrameLabels& labels);

void define_labels_check(CLI::App* labels, Line& line);
void define_labels_stats(CLI::App* labels, Line& line);
void define_labels_compare(CLI::App* labels, Line& line);
void define_labels_export(CLI::App* labels, Line& line);
void define_labels_import(CLI::App* labels, Line& line);
void define_labels_convert(CLI::App* labels, Line& line);

/// The options of recordings that make sense for a folder of labels, --recording and --json.
void add_label_inputs(CLI::App* command, LabelsArgs& args, const std::string& what);
/// Adds --labels, for commands that read labels.
void add_label_dir(CLI::App* command, LabelsArgs& args);

}  // namespace planescope::app
