// Opens recordings and label folders for the subcommands of planescope labels.

#include "app/commands/labels.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".labels";

bool is_label_folder(const fs::path& path) {
  if (!fs::is_directory(path)) return false;
  return without_slash(path).extension() == kSuffix || fs::exists(path / "journal") ||
         !labels::label_numbers(path).empty();
}

}  // namespace

LabelFolder list_labels(const fs::path& dir) {
  if (!fs::exists(dir))
    throw Error(dir.string() + ": no such folder; for labels elsewhere, use --labels DIR");
  if (!fs::is_directory(dir)) throw Error(dir.string() + ": not a label folder");
  std::vector<int> frames = labels::label_numbers(dir);
  if (frames.empty() && fs::exists(dir / "journal"))
    throw Error(
        dir.string() +
        ": contains only a journal and no label files yet; to write them, open the recording "
        "in label mode and save (Ctrl+S)");
  if (frames.empty())
    throw Error(dir.string() + ": contains no labels; expected files such as 000000.plane.png");
  return {dir, std::move(frames)};
}

LabeledRecording open_labels(const LabelsArgs& args) {
  if (args.input.inputs.size() != 1)
    throw Error(
        fmt::format("{} recordings or label folders; expected one", args.input.inputs.size()));
  const fs::path& given = args.input.inputs[0];
  LabeledRecording source;
  if (is_label_folder(given)) {
    source.labels = list_labels(given);
    source.path = args.recording;
    const fs::path beside = without_slash(given);
    if (source.path.empty() && beside.extension() == kSuffix &&
        fs::exists(fs::path(beside).replace_extension()))
      source.path = fs::path(beside).replace_extension();
  } else {
    if (!fs::exists(given)) throw Error(given.string() + ": no such file or folder");
    source.labels = list_labels(args.input.label_dir.value_or(labels::default_label_dir(given)));
    source.path = given;
  }
  io::RecordingOptions options = args.input.recording;
  options.intrinsics_may_lack = true;  // the label files then provide them
  if (source.path.empty()) return source;
  source.recording = io::open_recording(source.path, options);
  const labels::LabelsOfFrames found =
      labels::labels_of_frames(source.labels.dir, *source.recording, source.labels.frames);
  if (!found.warning.empty()) notice("warning: {}", found.warning);
  for (const auto& [frame, number] : found.number_of) source.frame_of[number] = frame;
  return source;
}

Frame frame_as_drawn(Frame frame, const io::RecordingInfo& info, const FrameLabels& labels) {
  const bool assumed = info.depth_unit_source.starts_with("assumed");
  if (assumed && labels.depth_unit_m > 0) frame.depth_unit_m = labels.depth_unit_m;
  if (!info.knows_camera()) frame.intrinsics = labels.intrinsics;
  return frame;
}

FrameLabels read_labels_of(const LabeledRecording& source, int number) {
  const auto& recording = source.recording;
  const int frame = source.frame(number);
  if (recording && frame >= recording->frame_count())
    throw Error(fmt::format("{}/{:06}.json: is for frame {}, but the recording has {} frames",
                            source.labels.dir.string(), number, frame, recording->frame_count()));
  // The size of a cloud is only known after reading the frame.
  const bool is_cloud = recording && recording->info().width == 0;
  const std::string hash =
      recording ? read_frame([&] { return recording->frame_hash(frame); }) : std::string();
  auto labels = is_cloud ? labels::read_labels_of_frame(source.labels.dir, recording->frame(frame),
                                                        hash, number)
                         : labels::read_frame_labels(source.labels.dir, number, hash);
  if (!labels)
    throw Error(fmt::format("{}/{:06}.json: no such file", source.labels.dir.string(), number));
  return std::move(*labels);
}

void add_label_inputs(CLI::App* command, LabelsArgs& args, const std::string& what) {
  add_inputs(command, args.input, what);
  for (const char* name : {"--frames", "--labels"})
    command->remove_option(command->get_option(name));
  add(command, "--recording", args.recording, "RECORDING",
      "Recording that the labels belong to (default: the one DIR.labels is named after)");
  add_json(command, args.json);
}

void add_label_dir(CLI::App* command, LabelsArgs& args) {
  add(command, "--labels", args.input.label_dir, "DIR",
      "Labels of the recording (default RECORDING.labels)");
}

void define_labels(CLI::App& app, Line& line) {
  CLI::App* labels = app.add_subcommand(
      "labels", "Check, compare, export, and import ground truth (docs/labels.md)");
  for (const auto define : {define_labels_check, define_labels_stats, define_labels_compare,
                            define_labels_export, define_labels_import, define_labels_convert})
    define(labels, line);
}

}  // namespace planescope::app
