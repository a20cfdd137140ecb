#pragma once

// What every command that reads recordings shares: which recordings, which frames, which options.

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

/// A:B:STEP as Python slices a list: negative numbers count from the end, an empty part is the
/// end of the list. A single number N is that one frame.
struct FrameSlice {
  std::optional<int> first, last, step;
};
FrameSlice parse_frame_slice(const std::string& text);  // throws Error
std::vector<int> sliced_frames(const FrameSlice& slice, int frame_count);
/// The same of a stream, whose number of frames is not known. Throws Error on negative numbers.
bool is_in_slice(const FrameSlice& slice, int frame);
bool is_past_slice(const FrameSlice& slice, int frame);

int all_cores();

struct InputArgs {
  InputArgs() { pipeline.threads = all_cores(); }

  std::vector<std::filesystem::path> inputs;       // empty: the sample recording that ships with us
  FrameSlice frames;                               // default: all
  io::RecordingOptions recording;                  // --intrinsics, --depth-unit, --topic, ...
  planes::PipelineOptions pipeline;                // --profile, --set, ...; by default on all cores
  std::optional<std::filesystem::path> label_dir;  // --labels; default <recording>.labels
  bool warnings_as_errors = false;
};

/// What was typed after --profile, --set, --gravity, --max-range, --voxel, --classifier, --method
/// or
/// --foot. Throws Error.
void set_pipeline_option(planes::PipelineOptions& options,
                         const std::string& name,
                         const std::string& text);
/// Sets one of the above, or --frames, --intrinsics, --depth-unit, --topic, --instance-field,
/// --labels.
void set_input_option(InputArgs& args, const std::string& name, const std::string& text);

/// A recording that was opened, and what of it is asked for.
struct OpenInput {
  std::filesystem::path path;
  std::shared_ptr<const io::Recording> recording;
  std::vector<int> frames;          // at least one; frame numbers of the recording
  std::filesystem::path label_dir;  // may not exist
  io::PickedGravity picked = {};
  std::shared_ptr<const world::SequenceGravity> gravity = {};  // null: frames have their own alone

  /// The number of the label files of frame `index`; nullopt: it has none. The first call looks
  /// whether frames were added or removed since they were labeled, and warns.
  std::optional<int> label_number(int index) const;
  /// The truth of a frame, from its label files or the fields of its cloud.
  std::optional<planes::SourceTruth> truth(const Frame& frame) const;
  /// Frame `index` with its gravity: its own or, where it has none, that of the frames around it.
  /// Throws FrameDamaged if it cannot be read.
  Frame frame(int index) const;

  struct LabelLookup {
    std::once_flag once;
    labels::LabelsOfFrames found;
  };
  std::shared_ptr<LabelLookup> label_lookup = std::make_shared<LabelLookup>();
};

/// Opens every input, or the sample where none is given, before any work is done; frames of
/// `recording` carry the gravity that was picked for them. Throws Error if one cannot be opened, if
/// --frames leaves none of its frames, or if the output `out` is in one of them.
std::vector<OpenInput> open_inputs(const InputArgs& args, const std::filesystem::path& out = {});

/// A frame that was read and run, with its truth where there is some (and it was asked for, or
/// `classifier truth` needs it).
struct LoadedFrame {
  Frame frame;
  planes::FrameResult result;
  std::optional<planes::SourceTruth> truth;
  planes::LimitRatios limit_ratios;  // of runs for a report
};

/// Those of `frames` that were found damaged when the recording was opened.
DamagedFrames damaged_at_open(const io::Recording& recording, const std::vector<int>& frames);

/// Reports them and takes them out of the frames to process, for measurements that need every
/// frame. Returns the exit code. Throws Error if no frame of a recording is left.
int leave_out_damaged(std::vector<OpenInput>& inputs);

/// False where frame `index` surely has no truth: no label file, and no cloud with fields. Throws
/// FrameDamaged if it was found damaged when the recording was opened.
bool may_have_truth(const OpenInput& input, int index);

/// A frame that was read but cannot be processed: no gravity, no truth. Other frames may still
/// work.
struct FrameRefused : Error {
  using Error::Error;
};

/// Whether points are labelled h or v at all: rivals do not use labels, and without gravity there
/// are none.
bool labels_points(const planes::PipelineOptions& options);

/// The classifier of these options, none where points are not labelled; gcn takes the weights that
/// ship with us. Throws Error where weights are missing or cannot be read.
planes::ChosenClassifier choose_classifier(const planes::PipelineOptions& options);

/// Reads frame `index` and runs it; `classifier` null: with the labels of its truth. Throws
/// FrameDamaged where it cannot be read, FrameRefused where run_frame throws; the message begins
/// with the recording and the frame.
LoadedFrame run_input_frame(const OpenInput& input,
                            int index,
                            const planes::PipelineOptions& options,
                            const planes::Classifier* classifier,
                            bool want_truth,
                            planes::Trace* trace = nullptr);

// Lists of recordings: lines of words, with options as they would be typed.

/// Calls read(words) for each line that is not empty and no comment. Throws Error naming the list
/// and the line where that throws one.
void read_list(const std::filesystem::path& list,
               const std::function<void(std::istringstream& words)>& read);

/// The rest of a line: options as they would be typed, of those that are `known`. Throws Error.
void set_listed_options(InputArgs& args,
                        std::istringstream& words,
                        std::span<const std::string> known);

}  // namespace planescope::app
