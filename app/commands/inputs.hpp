#pragma once

// Recording, frame and method options shared by the commands that read recordings.

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "app/cli/progress.hpp"
#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::app {

/// A Python slice A:B:STEP: negative numbers count from the end, and empty parts default to the
/// ends. A single number N selects frame N.
struct FrameSlice {
  std::optional<int> first, last, step;
};
FrameSlice parse_frame_slice(const std::string& text);  // throws Error
std::vector<int> sliced_frames(const FrameSlice& slice, int frame_count);
/// The same for a stream with an unknown number of frames. Throws Error for negative numbers.
bool is_in_slice(const FrameSlice& slice, int frame);
bool is_past_slice(const FrameSlice& slice, int frame);

int all_cores();

struct InputArgs {
  InputArgs() { pipeline.threads = all_cores(); }

  std::vector<std::filesystem::path> inputs;       // empty: the bundled sample recording
  FrameSlice frames;                               // default: all
  io::RecordingOptions recording;                  // --intrinsics, --depth-unit, --topic, ...
  planes::PipelineOptions pipeline;                // --profile, --set, ...; all cores by default
  std::optional<std::filesystem::path> label_dir;  // --labels; default <recording>.labels
  bool warnings_as_errors = false;
};

/// Sets --profile, --set, --gravity, --max-range, --voxel, --classifier, --method or --foot from
/// its command-line value. Throws Error.
void set_pipeline_option(planes::PipelineOptions& options,
                         const std::string& name,
                         const std::string& text);
/// Sets one of the above, or --frames, --intrinsics, --depth-unit, --topic, --instance-field or
/// --labels.
void set_input_option(InputArgs& args, const std::string& name, const std::string& text);

/// An open recording and the frames selected from it.
struct OpenInput {
  std::filesystem::path path;
  std::shared_ptr<const io::Recording> recording;
  std::vector<int> frames;          // at least one; frame numbers of the recording
  std::filesystem::path label_dir;  // may be missing
  io::PickedGravity picked = {};
  std::shared_ptr<const world::SequenceGravity> gravity = {};  // null: per-frame gravity only
  std::vector<std::string> warnings = {};  // about the recording and contradicting options

  /// Number of the label files of frame `index`; nullopt if it has none. The first call checks
  /// whether frames were added or removed since they were labeled, and warns.
  std::optional<int> label_number(int index) const;
  /// Ground truth of a frame, from its label files or the fields of its cloud.
  std::optional<planes::SourceTruth> truth(const Frame& frame) const;
  /// Reads frame `index` with its gravity: its own or, if it has none, that of the frames around
  /// it. Throws FrameDamaged if it is unreadable.
  Frame frame(int index) const;
  std::string name_of(int index) const;  // for messages: "a.bag, frame 3 (640x480)"

  struct LabelLookup {
    std::once_flag once;
    labels::LabelsOfFrames found;
  };
  std::shared_ptr<LabelLookup> label_lookup = std::make_shared<LabelLookup>();
};

/// Prints a warning or, with --warnings-as-errors, throws it as an Error.
void warn(const InputArgs& args, const std::string& warning);
/// Warning for a run without planes in any frame.
std::string no_planes_text(const std::string& recording, std::size_t frames);

/// Opens all inputs, or the sample if there are none, before any work is done. Frames of
/// `recording` have the gravity picked for them in the window. Throws Error if a recording cannot
/// be opened, --frames selects none of its frames, or the output `out` is inside it.
std::vector<OpenInput> open_inputs(const InputArgs& args, const std::filesystem::path& out = {});

/// A processed frame, with its ground truth if available and needed: requested by the caller or
/// used by `classifier truth`.
struct LoadedFrame {
  Frame frame;
  planes::FrameResult result;
  std::optional<planes::SourceTruth> truth;
  planes::LimitRatios limit_ratios;  // set when running for a report
};

/// Frames of `frames` that were found damaged when the recording was opened.
DamagedFrames damaged_at_open(const io::Recording& recording, const std::vector<int>& frames);

/// Reports damaged frames and removes them from the frames to process, for measurements that need
/// every frame. Returns the exit code. Throws Error if no frame of a recording is left.
int leave_out_damaged(std::vector<OpenInput>& inputs);

/// False if frame `index` cannot have ground truth: it has no label file and is not a cloud. Throws
/// FrameDamaged if it was found damaged when the recording was opened.
bool may_have_truth(const OpenInput& input, int index);

/// A readable frame that cannot be processed, e.g. for lack of gravity or ground truth. Other
/// frames may still work.
struct FrameRefused : Error {
  using Error::Error;
};

/// Whether points get h and v labels. Other methods do not use labels, and labels need gravity.
bool labels_points(const planes::PipelineOptions& options);

/// Returns the classifier for these options, or none if points are not labeled; gcn uses the
/// bundled weights. Throws Error if weights are missing or unreadable.
planes::ChosenClassifier choose_classifier(const planes::PipelineOptions& options);

/// Reads and processes frame `index`. A null `classifier` uses the labels of the ground truth.
/// Throws FrameDamaged if the frame is unreadable, and FrameRefused if run_frame() throws; the
/// message begins with the recording and the frame.
LoadedFrame run_input_frame(const OpenInput& input,
                            int index,
                            const planes::PipelineOptions& options,
                            const planes::Classifier* classifier,
                            bool want_truth,
                            planes::Trace* trace = nullptr);

// Lists of recordings: lines of words, with options as on the command line.

/// Calls read(words) for each line that is neither empty nor a comment. Errors are rethrown with
/// the list and line number.
void read_list(const std::filesystem::path& list,
               const std::function<void(std::istringstream& words)>& read);

/// Parses the rest of a line as command-line options from `known`. Throws Error.
void set_listed_options(InputArgs& args,
                        std::istringstream& words,
                        std::span<const std::string> known);

}  // namespace planescope::app
