#pragma once

// What every command that reads recordings shares: which recordings, which frames, which options.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
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
  std::vector<std::string> warnings = {};  // the recording's, and of options that contradict it

  /// Frame `index` with its gravity: its own or, where it has none, that of the frames around it.
  Frame frame(int index) const;
  std::string name_of(int index) const;  // for messages: "a.bag, frame 3 (640x480)"
};

/// Prints a warning or, with --warnings-as-errors, throws it as an Error.
void warn(const InputArgs& args, const std::string& warning);
/// The warning for a run that found no plane in any of its frames.
std::string no_planes_text(const std::string& recording, std::size_t frames);

/// Opens every input, or the sample where none is given, before any work is done; frames of
/// `recording` carry the gravity that was picked for them. Throws Error if one cannot be opened, or
/// if --frames leaves none of its frames.
std::vector<OpenInput> open_inputs(const InputArgs& args);

/// A frame that was read and run, with its truth where there is some (and it was asked for, or
/// `classifier truth` needs it).
struct LoadedFrame {
  Frame frame;
  planes::FrameResult result;
  std::optional<planes::SourceTruth> truth;
  planes::LimitRatios limit_ratios;  // of runs for a report
};

/// False where frame `index` surely has no truth: no label file, and no cloud with fields.
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

/// Reads frame `index` and runs it; `classifier` null: with the labels of its truth. Throws Error
/// where it cannot be read, FrameRefused where run_frame throws; the message begins with the
/// recording and the frame.
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
