#pragma once

// Background work: reading and processing frames, thumbnails, searches. The state describes
// wanted work; pursue() starts missing work and collect() delivers results.

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "app/desktop/jobs/request.hpp"
#include "app/desktop/state/state.hpp"
#include "core/debug/replay/run.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::desktop {

// Work on one frame: reading, preparing and processing it, for the views and the strip.

/// Resources shared by frames and created once: classifiers loaded from files, and gravity over the
/// recording. Thread-safe.
class FrameTools {
 public:
  /// Null for labels of the ground truth, and for methods without a classifier.
  std::shared_ptr<const planes::Classifier> classifier(const planes::PipelineOptions& options);
  std::shared_ptr<const world::SequenceGravity> gravity(
      const std::shared_ptr<const io::Recording>& recording, const planes::GravityOptions& options);

 private:
  std::mutex mutex_;
  std::string key_;
  std::shared_ptr<const planes::Classifier> chosen_;
  std::shared_ptr<const io::Recording> gravity_of_;
  planes::GravityOptions gravity_by_;
  std::shared_ptr<const world::SequenceGravity> gravity_;
};

/// The inputs that determine a frame's result.
struct Wanted {
  std::shared_ptr<const io::Recording> recording;
  std::filesystem::path label_dir;
  int frame = 0;
  planes::PipelineOptions options;
  io::PickedGravity picked = {};
  int labels_version = 0;                   // ground truth is read from label files
  std::shared_ptr<const MapView> map = {};  // provides gravity
  std::string prepare_key, segment_key;     // of the options: equal texts give equal results

  std::string key() const { return prepare_key + segment_key; }  // run_key() of the options

  bool same_subject(const Wanted& other) const {
    return recording == other.recording && frame == other.frame &&
           labels_version == other.labels_version && prepare_key == other.prepare_key &&
           picked == other.picked && map == other.map;
  }
  bool operator==(const Wanted& other) const {
    return same_subject(other) && segment_key == other.segment_key;
  }
  /// Whether the frame is still current; otherwise its result must not replace the shown one.
  bool is_shown(const Document& document) const {
    return document.current() && document.current()->recording == recording &&
           document.frame == frame;
  }
};
Wanted wanted_of(const Document& document, int frame);
/// The same with the map in which its planes were tracked, if any.
Wanted wanted_in(const State& state, int frame);
/// Key of the options that affect a run: equal texts give equal runs.
std::string run_key(const planes::PipelineOptions& options);
Wanted with_options(Wanted wanted, const planes::PipelineOptions& options);

/// Colors of planes by frame. The strip fills it outwards from its first frame, and each frame
/// continues the colors of the nearest one in the book. A frame opened before the strip reaches it
/// gets its colors the same way, but they are not stored. Thread-safe.
class ColorBook {
 public:
  /// `like` is the currently shown version of the frame, whose colors are kept; null: use the
  /// nearest frame in the book. If a map tracks the planes, their tracks decide.
  FrameColors colors(const Wanted& wanted,
                     const debug::Run& run,
                     const render::ColoredPlanes* like = nullptr) const;
  void keep(const Wanted& wanted, const FrameColors& colors);

 private:
  std::shared_ptr<const render::ColoredPlanes> nearest(const Wanted& wanted) const;

  mutable std::mutex mutex_;
  std::shared_ptr<const io::Recording> recording_;
  std::map<int, FrameColors> of_frame_;
};

// These functions throw the errors of reading and preparing.
/// A frame with unknown gravity is prepared without h and v. `refused_labels` receives the reason
/// why label files cannot serve as ground truth, and the frame is loaded without them; if it is
/// null, the error is thrown.
std::shared_ptr<const debug::Subject> load_subject(const Wanted& wanted,
                                                   FrameTools& tools,
                                                   std::string* refused_labels = nullptr);
std::shared_ptr<const RunView> view_run(std::shared_ptr<const debug::Run> run,
                                        const render::Home& home,
                                        const Wanted& wanted,
                                        FrameColors colors);
render::Home home_of(const debug::Run& run);
/// The thumbnail of a frame that cannot be processed contains the reason. Stores its plane colors
/// in the book. See ColorBook::colors() for `like`.
Thumbnail thumbnail_of(const Wanted& wanted,
                       FrameTools& tools,
                       ColorBook& book,
                       const render::ColoredPlanes* like = nullptr);
/// Only the camera image or shaded depth, without processing the frame.
Thumbnail picture_of(const Wanted& wanted);

// Analysis of a run's planes: outlines immediately, footholds and stairs later.

/// Computes only outlines, without fills, in a few milliseconds. Null if GEOS fails.
std::shared_ptr<const render::PlaneScene> outlines_of_run(const debug::Run& run);

/// Computes everything, using the options that do not affect the run. Throws Error.
std::shared_ptr<const RunPlanes> planes_of_run(const std::shared_ptr<const RunView>& view,
                                               const planes::PipelineOptions& options);

/// Key of the options that affect planes_of_run(): equal texts give equal results.
std::string planes_key(const planes::PipelineOptions& options);
/// Whether an option applies to finished planes and does not affect runs.
bool is_about_planes(const planes::OptionInfo& info);

// Writes pictures of steps to an animated PNG in the background: the window draws one step after
// another, and a thread compresses and writes them. The file appears only when complete.

class StepsFile;

class StepsSaver {
 public:
  /// `wake` is called from another thread after each written picture.
  explicit StepsSaver(std::function<void()> wake);
  ~StepsSaver();  // removes an incomplete file

  /// Sets the state to the next step, which must be drawn and passed to add(). Returns false if no
  /// picture is wanted or there is no room for it yet. Reports the result when the file is
  /// finished.
  bool begin(State& state, bool still_at_work);
  void add(State& state, Image8 picture);
  /// Whether pictures are wanted or being written.
  bool active(const State& state) const { return state.view.saving || file_; }
  bool has_room() const;
  /// Call for each drawn frame. If drawn frames take no pictures, the file is abandoned.
  void note_frame(State& state);

 private:
  void end(State& state, const std::string& message, bool is_error);

  std::function<void()> wake_;
  std::unique_ptr<StepsFile> file_;
  int frames_without_ = 0;
};

class Jobs {
 public:
  /// `wake` is called from other threads when there is something to collect.
  explicit Jobs(std::function<void()> wake);
  ~Jobs() { courier_.end(); }  // stops all work first, then waits for each thread
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  void pursue(State& state);
  /// Returns true if the state has changed.
  bool collect(State& state);
  /// Whether work is running or its result is not delivered yet. `background` includes work for the
  /// frame strip and the sliders' curves.
  bool busy(bool background = true) const;

 private:
  Courier courier_;
  FrameTools tools_;
  std::vector<std::unique_ptr<JobGroup>> groups_;  // last: their threads use the members above
};

// Job groups. The courier and tools must outlive them.

/// Frames: runs, planes, comparisons and the strip.
std::unique_ptr<JobGroup> make_frame_jobs(Courier& courier, FrameTools& tools);
/// Runs with other options: the search for fixes, the check of a fix on all labeled frames, and the
/// sliders' curves. One at a time: a later job replaces an earlier one, and curves wait while
/// `frame_is_run` returns true.
std::unique_ptr<JobGroup> make_analysis_jobs(Courier& courier,
                                             FrameTools& tools,
                                             std::function<bool()> frame_is_run);
/// Label mode: the frame's grid, the review queue, checks, and carrying labels.
std::unique_ptr<JobGroup> make_label_jobs(Courier& courier);
/// Work over a whole recording: tracking planes, proposing labels, training.
std::unique_ptr<JobGroup> make_recording_jobs(Courier& courier, FrameTools& tools);

}  // namespace planescope::desktop
