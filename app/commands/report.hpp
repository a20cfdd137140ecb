#pragma once

// planescope report: the folder in which a report is made, its frames, which are run and drawn on
// all cores, their pictures, and the command.

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

/// Each frame is named by its folder below DIR, "01-a.bag/frames/000012". They are written below
/// DIR/.report-work; commit() moves them to their place, over what stood there.
class ReportFolder {
 public:
  /// Without `resume`, deletes what a stopped run left. Throws Error where DIR cannot be written
  /// to, or another run writes into it.
  ReportFolder(const std::filesystem::path& dir, bool resume);
  /// Keeps finished frames, of this run or of an earlier one, for a run that resumes.
  ~ReportFolder();
  ReportFolder(const ReportFolder&) = delete;
  ReportFolder& operator=(const ReportFolder&) = delete;

  /// The frame as an earlier run left it, if it had the same key and its files are there.
  std::optional<report::ReportFrame> find(const std::filesystem::path& frame,
                                          const std::string& key);
  bool has(const std::filesystem::path& frame) const;
  /// An empty folder for the frame's files, with `pictures` and `report` in it.
  std::filesystem::path start(const std::filesystem::path& frame);
  void finish(const std::filesystem::path& frame,
              const report::ReportFrame& record,
              bool ours,
              const std::string& key);
  /// A finished frame's files, copied from another report in `dir`.
  void take(const std::filesystem::path& frame, const std::filesystem::path& dir);
  /// A frame that was finished, found or taken.
  report::ReportFrame read(const std::filesystem::path& frame) const;

  /// `whole`: the report is complete; then removes the work folder, and frames of an earlier
  /// report that are not in `frames`.
  void commit(bool whole, const std::set<std::filesystem::path>& frames);
  void give_up();  // finished frames are not kept either

 private:
  std::filesystem::path place_of(const std::filesystem::path& frame) const;
  /// An unused place in the work folder for a part of a frame's folder.
  std::filesystem::path aside(const std::filesystem::path& part) const;
  void set_aside(const std::filesystem::path& part) const;
  void put_in_place(const std::filesystem::path& part) const;
  void remove_others(const std::set<std::filesystem::path>& frames);

  std::filesystem::path dir_, work_;
  std::vector<std::filesystem::path> made_dirs_;  // outermost first
  FolderLock lock_;
  bool over_ = false;  // nothing in work_ is wanted any more
  mutable std::mutex mutex_;
  std::set<std::filesystem::path> finished_;  // in work_
};

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
  bool colors_only = false;      // of another shard; run to continue its plane colors
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
  planes::PipelineOptions options;
  const planes::Classifier* classifier = nullptr;
  FrameRunner run;
  std::string build_key;  // of everything except the input
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

/// "#rrggbb".
std::string css_color(render::Rgba color);

/// Drawing failed, as opposed to writing the picture.
struct DrawingFailed : Error {
  using Error::Error;
};

struct PictureJob {
  std::filesystem::path dir;       // the frame's folder, with `pictures` and `report` in it
  std::filesystem::path relative;  // the same folder, as the report names it
  int copy_width = 1280;           // width of pictures in the page [px]
  double max_range_m = 1.5;
  planes::Method method = planes::Method::ours;  // others have no labels and no octree to draw
};

/// One picture per stage, written as PNG, with two smaller copies for the page. Without a renderer
/// only those that are made in image space. The same frame gives the same pixels for any thread
/// count.
std::vector<report::ReportPicture> draw_pictures(const LoadedFrame& loaded,
                                                 const std::vector<int>& color_of_plane,
                                                 render::Renderer* renderer,
                                                 const PictureJob& job);

/// What a report is held to.
struct ReportGuardArgs {
  std::filesystem::path baseline;  // an earlier report.json; empty: none
  std::filesystem::path rules;  // planescope.rules.json; empty: with a baseline, the built-in ones
  bool approve = false;         // the report's recordings become the baseline's
  bool approve_only = false;    // and the baseline has no others
};

struct ReportArgs {
  InputArgs input;
  std::filesystem::path out;  // -o
  bool json = false;          // --json: print the path and the totals as JSON on stdout
  bool init = false;          // write the built-in rules and no report
  std::string command;        // as it was typed, without what changes no frame
  ReportGuardArgs guard;
  Shard shard;          // which part of the frames
  bool resume = false;  // frames that an earlier run finished are taken as they are
  bool pictures = true;
  bool tracks = false;  // planes are followed over the frames of each recording
};

/// Writes the report, or with `init` the rules. Returns the exit code: 0; 2 if a frame is damaged
/// (the others are in the report); 1 if a rule of level error is broken and nothing was approved; 3
/// if rendering failed and the data files were still written. Throws Error on bad
/// input, Cancelled (after a valid partial report) on stop.
int run_report(const ReportArgs& args,
               std::stop_token stop,
               const FrameRunner& runner = run_report_frame);

}  // namespace planescope::app
