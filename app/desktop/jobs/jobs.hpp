#pragma once

// Work that the window does not wait for: reading frames, running them, thumbnails, searches. The
// state says what is wanted; pursue() starts what is missing, collect() hands over what is done.

#include <memory>
#include <vector>

#include "app/desktop/jobs/frame_work.hpp"
#include "app/desktop/jobs/request.hpp"

namespace planescope::desktop {

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
