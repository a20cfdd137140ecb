#pragma once

// planescope report: its output folder, its frames, which are processed and drawn on all cores,
// their pictures, and the command.

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/report/data/report_data.hpp"
#include "render/renderer.hpp"

namespace planescope::app {

/// Output folder of a report. Each frame is identified by its folder below DIR, for example
/// "01-a.bag/frames/000012". Frames are written below DIR/.report-work; commit() moves them to
/// their final paths, replacing earlier ones.
class ReportFolder {
 public:
  /// Without `resume`, deletes the remains of an interrupted run. Throws Error if DIR is not
  /// writable or another run is writing to it.
  ReportFolder(const std::filesystem::path& dir, bool resume);
  /// Keeps finished frames of this and earlier runs for --resume.
  ~ReportFolder();
  ReportFolder(const ReportFolder&) = delete;
  ReportFolder& operator=(const ReportFolder&) = delete;

  /// Returns the frame of an earlier run if its key is the same and its files exist.
  std::optional<report::ReportFrame> find(const std::filesystem::path& frame,
                                          const std::string& key);
  bool has(const std::filesystem::path& frame) const;
  /// Returns an empty folder for the frame's files, with subfolders `pictures` and `report`.
  std::filesystem::path start(const std::filesystem::path& frame);
  void finish(const std::filesystem::path& frame,
              const report::ReportFrame& record,
              bool ours,
              const std::string& key);
  /// Copies a finished frame's files from another report in `dir`.
  void take(const std::filesystem::path& frame, const std::filesystem::path& dir);
  /// Reads a frame that was finished, found or taken.
  report::ReportFrame read(const std::filesystem::path& frame) const;

  /// `whole`: the report is complete; also removes the work folder, and frames of an earlier report
  /// that are not in `frames`.
  void commit(bool whole, const std::set<std::filesystem::path>& frames);
  void give_up();  // discards finished frames too

 private:
  std::filesystem::path place_of(const std::filesystem::path& frame) const;
  /// Returns an unused path in the work folder for part of a frame's folder.
  std::filesystem::path aside(const std::filesystem::path& part) const;
  void set_aside(const std::filesystem::path& part) const;
  void put_in_place(const std::filesystem::path& part) const;
  void remove_others(const std::set<std::filesystem::path>& frames);

  std::filesystem::path dir_, work_;
  std::vector<std::filesystem::path> made_dirs_;  // outermost first
  FolderLock lock_;
  bool over_ = false;  // work_ is no longer needed
  mutable std::mutex mutex_;
  std::set<std::filesystem::path> finished_;  // in work_
};

/// Folder of a frame's files below the report: "frames/000012", or "01-a.bag/frames/000012" with
/// several recordings.
std::filesystem::path report_frame_folder(std::size_t recordings,
                                          std::size_t recording,
                                          const std::string& name,
                                          int index);

/// Part `index` of `count`; both start at 1.
struct Shard {
  int index = 1, count = 1;
};
Shard parse_shard(const std::string& text);  // "2/8"; throws Error

/// The last component of each path; duplicates are prefixed with the parent folder: "scan1-depth".
std::vector<std::string> recording_names(const std::vector<OpenInput>& inputs);

/// A frame requested for a report.
struct ReportSlot {
  std::size_t input = 0;
  int index = 0;                 // frame number in the recording
  std::filesystem::path folder;  // below the report, "01-a.bag/frames/000012"
  bool colors_only = false;      // from another shard; processed only to continue plane colors
  bool done = false;
  bool found = false;  // unchanged from an earlier run
};
/// All frames of this shard in order, per recording, preceded by the frames of other shards on
/// which their colors depend.
std::vector<ReportSlot> report_slots(const std::vector<OpenInput>& inputs, const Shard& shard);

/// Processes a frame: run_input_frame(), or a substitute that injects faults in tests.
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
  planes::PipelineOptions options;
  const planes::Classifier* classifier = nullptr;
  FrameRunner run;
  std::string build_key;  // hash key of everything except the input
  int copy_width = 1280;
  bool resume = false;
  bool pictures = true;
};

struct ReportDrawing {
  std::string renderer;  // GL renderer
  std::string error;     // why drawing failed or stopped; frames are then written without these
                         // pictures
};

/// Writes every slot that is missing in `folder` and marks it done; frames that cannot be processed
/// get records too. Stops between frames. Throws Error if a file cannot be written.
ReportDrawing write_report_frames(const ReportFramesJob& job,
                                  ReportFolder& folder,
                                  std::vector<ReportSlot>& slots,
                                  const std::stop_token& stop);

/// Returns "#rrggbb".
std::string css_color(render::Rgba color);

/// Drawing failed, as opposed to writing a picture.
struct DrawingFailed : Error {
  using Error::Error;
};

struct PictureJob {
  std::filesystem::path dir;       // the frame's folder, with subfolders `pictures` and `report`
  std::filesystem::path relative;  // the same folder, relative to the report
  int copy_width = 1280;           // width of pictures on the page [px]
  double max_range_m = 1.5;
  planes::Method method = planes::Method::ours;  // others have no labels and no octree to draw
};

/// Draws one picture per stage and writes it as PNG with two smaller copies for the page. Without a
/// renderer, only pictures in image space are drawn. The pixels of a frame do not depend on the
/// number of threads.
std::vector<report::ReportPicture> draw_pictures(const LoadedFrame& loaded,
                                                 const std::vector<int>& color_of_plane,
                                                 render::Renderer* renderer,
                                                 const PictureJob& job);

/// Baseline and rules that a report is checked against.
struct ReportGuardArgs {
  std::filesystem::path baseline;  // an earlier report.json; empty: none
  std::filesystem::path rules;  // planescope.rules.json; empty: with a baseline, the built-in ones
  bool approve = false;         // copy the report's recordings to the baseline
  bool approve_only = false;    // and remove all others from it
};

struct ReportArgs {
  InputArgs input;
  std::filesystem::path out;  // -o
  bool json = false;          // --json: print the path and the totals as JSON on stdout
  bool init = false;          // write the built-in rules instead of a report
  std::string command;        // as typed, without options that do not affect frames
  ReportGuardArgs guard;
  Shard shard;          // part of the frames to process
  bool resume = false;  // reuse frames that an earlier run finished
  bool pictures = true;
  bool tracks = false;  // track planes over the frames of each recording
};

/// Writes the report, or with `init` the rules. Returns the exit code: 0; 1 if a rule of level
/// error is violated and not approved; 2 if a frame is damaged (the others are in the report); 3 if
/// rendering failed and the data files were still written. Throws Error on bad input, Cancelled
/// (after a valid partial report) on stop.
int run_report(const ReportArgs& args,
               std::stop_token stop,
               const FrameRunner& runner = run_report_frame);

}  // namespace planescope::app
