#pragma once

// Options and label-folder handling shared by the subcommands of planescope labels.

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
  std::filesystem::path recording;  // --recording; empty: derived from the name of the label folder
  std::string format;
  std::filesystem::path from, out;
  bool strict = false;  // hints count as findings
  bool json = false;
};

struct LabelFolder {
  std::filesystem::path dir;
  std::vector<int> frames;  // frames with label files; ascending, not empty
};
/// Throws Error if the folder does not exist or contains no labels.
LabelFolder list_labels(const std::filesystem::path& dir);

/// A folder of labels and, if found, the recording to which they belong.
struct LabeledRecording {
  LabelFolder labels;
  std::filesystem::path path;
  std::unique_ptr<io::Recording> recording;  // null: not found
  std::map<int, int> frame_of;               // frame in the recording, by label file number

  /// The number itself if nothing is known.
  int frame(int number) const {
    const auto at = frame_of.find(number);
    return at == frame_of.end() ? number : at->second;
  }
};
/// Opens the recording or label folder on the command line.
LabeledRecording open_labels(const LabelsArgs& args);

/// Reads the label files with this number. Throws Error if they are damaged or belong to another
/// depth image.
FrameLabels read_labels_of(const LabeledRecording& source, int number);
/// Returns the frame with the depth unit and intrinsics of its labels where the recording only
/// assumes or lacks them.
Frame frame_as_drawn(Frame frame, const io::RecordingInfo& info, const FrameLabels& labels);

void define_labels_check(CLI::App* labels, Line& line);
void define_labels_stats(CLI::App* labels, Line& line);
void define_labels_compare(CLI::App* labels, Line& line);
void define_labels_export(CLI::App* labels, Line& line);
void define_labels_import(CLI::App* labels, Line& line);
void define_labels_convert(CLI::App* labels, Line& line);

/// Adds --recording, --json and the recording options that apply to a folder of labels.
void add_label_inputs(CLI::App* command, LabelsArgs& args, const std::string& what);
/// Adds --labels, for commands that read labels.
void add_label_dir(CLI::App* command, LabelsArgs& args);

}  // namespace planescope::app
