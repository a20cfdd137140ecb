#pragma once

// Planes followed over all frames, in the background.

#include <functional>
#include <memory>

#include "app/desktop/jobs/frame_work.hpp"
#include "app/desktop/jobs/worker.hpp"

namespace planescope::desktop {

class MapJobs {
 public:
  /// As LabelJobs.
  MapJobs(std::function<void(std::function<void(State&)>)> deliver, std::function<void()> wake);
  ~MapJobs();

  void pursue(State& state);
  bool busy() const { return worker_.busy(); }

 private:
  std::function<void(std::function<void(State&)>)> deliver_;
  // Touched by the window's thread only.
  bool asked_ = false;
  int number_ = 0;  // of the latest; what an earlier one still delivers is dropped
  FrameTools tools_;
  Worker worker_;  // last: its thread uses all of the above
};

}  // namespace planescope::desktop
