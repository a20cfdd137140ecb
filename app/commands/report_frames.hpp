#pragma once

// The frames of a report: run and drawn on all cores, each saved when it is finished.

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "app/commands/report_folder.hpp"

namespace planescope::app {

/// Where a frame's files lie below the report: "frames/000012", of several recordings
/// "01-a.bag/frames/000012".
std::filesystem::path report_frame_folder(std::size_t recordings,
                                          std::size_t recording,
                                          const std::string& name,
                                          int index);

/// Part `index` of `count`, from 1.
struct Shard {
  int index = 1, count = 1;
};
Shard parse_shard(const std::string& text);  // "2/8"; throws Error

/// The last part of each path; where two are equal, with the parent folder before it,
/// "scan1-depth".
std::vector<std::string> recording_names(const std::vector<OpenInput>& inputs);

/// A frame that a report is asked for.
struct ReportSlot {
  std::size_t input = 0;
  int index = 0;                 // the recording's frame
  std::filesystem::path folder;  // below the report, "01-a.bag/frames/000012"
  bool colors_only = false;      // of another shard; this one continues its planes' colours
  bool done = false;
  bool found = false;  // as an earlier run left it
};
/// All frames of this shard, each recording's in order; before them those of other shards that
/// their colours follow from.
std::vector<ReportSlot> report_slots(const std::vector<OpenInput>& inputs, const Shard& shard);

/// How a frame is run: run_input_frame(), unless a test wants a fault in it.
using FrameRunner = std::function<LoadedFrame(const OpenInput& input,
                                              int index,
                                              const planes::PipelineOptions& options,
                                              const planes::Classifier*)>;

LoadedFrame run_report_frame(const OpenInput& input,
                             int index,
                             const planes::PipelineOptions& options,
                             const planes::Classifier* classifier);

struct ReportFramesJob {
  const std::vector<OpenInput>& inputs;
  const planes::PipelineOptions& options;
  const planes::Classifier* classifier = nullptr;
  FrameRunner run;
  std::string build_key;  // of all but the input
  int copy_width = 1280;
  bool resume = false;
  bool pictures = true;
};

struct ReportDrawing {
  std::string renderer;  // which GL drew
  std::string error;     // why it could not, or stopped; the frames go on without
};

/// Fills `folder` with every slot that is not there yet, and marks it done; those that could not be
/// processed are records too. Stops between frames. Throws Error where a file cannot be written.
ReportDrawing write_report_frames(const ReportFramesJob& job,
                                  ReportFolder& folder,
                                  std::vector<ReportSlot>& slots,
                                  const std::stop_token& stop);

}  // namespace planescope::app
