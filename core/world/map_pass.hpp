#pragma once

// One way through the frames of a map's recording.

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

inline void tell(const MapJob& job, const char* what, int done, int all) {
  if (job.progress) job.progress(what, done, all);
}

/// Of each frame of the job; null: it has none.
std::vector<const CameraPose*> poses_by_frame(const MapJob& job, const UprightPoses& upright);

/// What is offered to each frame: nothing, the tracks before it, or all of an earlier pass.
enum class Offer { nothing, so_far, all };

/// The frames of a job, taken in one after the other.
struct Pass {
  Tracker tracker;
  std::map<int, StoredPlanes> stored;
  std::vector<std::string> refused;  // frames that could not be read or worked on, a line each
  int without_pose = 0;
  std::optional<Pace> pace;
};

/// `earlier`: the pass whose tracks are offered (Offer::all). `what`: for MapJob::progress. The
/// last pass calls the job's other functions.
Pass pass_through(const MapJob& job,
                  const UprightPoses& upright,
                  Offer offer,
                  const Tracker* earlier,
                  const char* what,
                  bool is_last);

/// Frames of a job at these poses, to which nothing is offered; `take` has them in this order, null
/// where one cannot be read.
void observe_each(const MapJob& job,
                  const UprightPoses& upright,
                  const std::vector<const CameraPose*>& poses,
                  const std::function<void(const ObservedFrame*)>& take);

}  // namespace planescope::world
