#pragma once

// Work that the window does not wait for: reading frames, running them, thumbnails, searches. The
// state says what is wanted; pursue() starts what is missing, collect() hands over what is done.

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

// What jobs do to a frame: reading, preparing and running it, for the views and for the strip.

/// What frames have in common and is made once: the classifier, as a network is read from its file,
/// and what is known of gravity over the recording. Any thread.
class FrameTools {
 public:
  /// Null: the labels of the ground truth, or a method that needs none.
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

/// What is wanted of a frame.
struct Wanted {
  std::shared_ptr<const io::Recording> recording;
  std::filesystem::path label_dir;
  int frame = 0;
  planes::PipelineOptions options;
  io::PickedGravity picked = {};
  int labels_version = 0;                   // truth is read from label files
  std::shared_ptr<const MapView> map = {};  // whose gravity the frame is to have
  std::string prepare_key, segment_key;     // of the options: equal texts, equal results

  std::string key() const { return prepare_key + segment_key; }  // run_key() of the options

  bool same_subject(const Wanted& other) const {
    return recording == other.recording && frame == other.frame &&
           labels_version == other.labels_version && prepare_key == other.prepare_key &&
           picked == other.picked && map == other.map;
  }
  bool operator==(const Wanted& other) const {
    return same_subject(other) && segment_key == other.segment_key;
  }
  /// The frame is still looked at: a result of another one must not take its place.
  bool is_shown(const Document& document) const {
    return document.current() && document.current()->recording == recording &&
           document.frame == frame;
  }
};
Wanted wanted_of(const Document& document, int frame);
/// The same with the map that its planes were followed in, if they were.
Wanted wanted_in(const State& state, int frame);
/// Of the options that runs go by: equal texts, equal runs.
std::string run_key(const planes::PipelineOptions& options);
Wanted with_options(Wanted wanted, const planes::PipelineOptions& options);

/// Colors of the planes of a recording's frames. The strip fills it, outwards from the frame that
/// it begins with, and each frame takes over the colors of the nearest one in the book. A frame
/// opened before the strip reaches it gets colors the same way, but they are not kept. Any thread.
class ColorBook {
 public:
  /// `like`: the same frame as it is shown so far, whose colors planes keep; null: the nearest one
  /// in the book. Where a map follows the planes, their tracks decide.
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

// All throw what reading and preparing throw.
/// A frame whose gravity cannot be told is prepared without h and v.
/// `refused_labels`: takes why label files cannot be ground truth, and the frame goes without;
/// where it is null, that is thrown.
std::shared_ptr<const debug::Subject> load_subject(const Wanted& wanted,
                                                   FrameTools& tools,
                                                   std::string* refused_labels = nullptr);
std::shared_ptr<const RunView> view_run(std::shared_ptr<const debug::Run> run,
                                        const render::Home& home,
                                        const Wanted& wanted,
                                        FrameColors colors);
render::Home home_of(const debug::Run& run);
/// A frame that cannot be run says why. The book keeps the colors of its planes. `like`: as in
/// ColorBook::colors().
Thumbnail thumbnail_of(const Wanted& wanted,
                       FrameTools& tools,
                       ColorBook& book,
                       const render::ColoredPlanes* like = nullptr);
/// The camera's picture alone, or shaded depth: nothing is run for it.
Thumbnail picture_of(const Wanted& wanted);

// What a run's planes are worth: their outlines at once, room for a foot and stairs a little later.

/// The outlines alone, without fills: they take a few milliseconds. Null where GEOS refuses them.
std::shared_ptr<const render::PlaneScene> outlines_of_run(const debug::Run& run);

/// Everything; of the options, what does not steer the run. Throws Error.
std::shared_ptr<const RunPlanes> planes_of_run(const std::shared_ptr<const RunView>& view,
                                               const planes::PipelineOptions& options);

/// Of options: equal texts, and planes_of_run() tells the same of a run.
std::string planes_key(const planes::PipelineOptions& options);
/// Whether an option is about finished planes, and changes no run.
bool is_about_planes(const planes::OptionInfo& info);

// Pictures of steps, written into an animated PNG while the window goes on: it draws one step after
// the other, a thread packs and writes them. The file is there once it is whole, and not before.

class StepsFile;

class StepsSaver {
 public:
  /// `wake`: called from another thread whenever a picture was written.
  explicit StepsSaver(std::function<void()> wake);
  ~StepsSaver();  // what is not whole is not left behind

  /// The next step is in the state, to be drawn and handed to add(). False where none is wanted or
  /// there is no room for it yet. Says what became of the file once that is known.
  bool begin(State& state, bool still_at_work);
  void add(State& state, Image8 picture);
  /// Pictures are wanted, or being written.
  bool active(const State& state) const { return state.view.saving || file_; }
  bool has_room() const;
  /// Called for each frame that is drawn: where none of them takes pictures, the file is given up.
  void note_frame(State& state);

 private:
  void end(State& state, const std::string& message, bool is_error);

  std::function<void()> wake_;
  std::unique_ptr<StepsFile> file_;
  int frames_without_ = 0;
};

class Jobs {
 public:
  /// `wake`: called from other threads whenever there is something to collect.
  explicit Jobs(std::function<void()> wake);
  ~Jobs() { courier_.end(); }  // all of it at once, then each is waited for
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  void pursue(State& state);
  /// True where the state has changed.
  bool collect(State& state);
  /// Something is under way whose result is not handed over yet. `background`: also what only fills
  /// the frame strip and sweeps the sliders.
  bool busy(bool background = true) const;

 private:
  Courier courier_;
  FrameTools tools_;
  std::vector<std::unique_ptr<JobGroup>> groups_;  // last: their threads use the above
};

// The groups. Courier and tools outlive them.

/// Frames: their runs, planes, comparisons and the strip.
std::unique_ptr<JobGroup> make_frame_jobs(Courier& courier, FrameTools& tools);
/// Runs with other options: the search for fixes, the check of one on all labeled frames, and the
/// curves in the sliders. One at a time, a later one replaces an earlier one; curves wait while
/// `frame_is_run`.
std::unique_ptr<JobGroup> make_analysis_jobs(Courier& courier,
                                             FrameTools& tools,
                                             std::function<bool()> frame_is_run);
/// What the label mode needs of a frame: its grid, the review's queue, checks, labels carried on.
std::unique_ptr<JobGroup> make_label_jobs(Courier& courier);
/// What goes over all frames of a recording: following planes, proposing labels, learning.
std::unique_ptr<JobGroup> make_recording_jobs(Courier& courier, FrameTools& tools);

}  // namespace planescope::desktop
