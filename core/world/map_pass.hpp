#pragma once

// One pass over the frames of a recording.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/model/error.hpp"
#include "core/world/map_recording.hpp"

namespace planescope::world {

inline void check_stop(const MapJob& job) {
  if (job.stop.stop_requested()) throw Cancelled();
}

inline void report_progress(const MapJob& job, const char* what, int done, int all) {
  if (job.progress) job.progress(what, done, all);
}

/// The pose of each frame of the job; null if it has none.
std::vector<const CameraPose*> poses_by_frame(const MapJob& job, const UprightPoses& upright);

/// Candidates for each frame: none, the tracks so far, or all tracks of an earlier pass.
enum class Offer { nothing, so_far, all };

/// Result of one pass.
struct Pass {
  Tracker tracker;
  std::map<int, StoredPlanes> stored;
  std::vector<std::string> refused;  // frames that failed, one line each
  int without_pose = 0;
  std::optional<Pace> pace;
};

/// `earlier`: the pass whose tracks are offered (Offer::all). `what`: for MapJob::progress. Only
/// the last pass calls on_frame, on_planes and on_left.
Pass pass_through(const MapJob& job,
                  const UprightPoses& upright,
                  Offer offer,
                  const Tracker* earlier,
                  const char* what,
                  bool is_last);

/// Observes the frames at these poses without candidates. Calls `take` in this order, and not for
/// frames that failed; returns these, a line each.
std::vector<std::string> observe_each(const MapJob& job,
                                      const UprightPoses& upright,
                                      const std::vector<const CameraPose*>& poses,
                                      const std::function<void(const ObservedFrame&)>& take);

}  // namespace planescope::world
