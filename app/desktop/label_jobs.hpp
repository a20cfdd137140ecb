#pragma once

// What the label mode does not wait for: making a frame ready, the review's queue, checks, carrying
// labels on.

#include <functional>
#include <memory>
#include <string>

#include "app/desktop/state.hpp"
#include "app/desktop/worker.hpp"

namespace planescope::desktop {

class LabelJobs {
 public:
  /// `deliver`: hands a change of the state to the window's thread; called from any thread. `wake`
  /// as of Jobs.
  LabelJobs(std::function<void(std::function<void(State&)>)> deliver, std::function<void()> wake);
  ~LabelJobs();

  void pursue(State& state);
  bool busy() const;

 private:
  void pursue_frame(State& state);

  std::function<void(std::function<void(State&)>)> deliver_;
  // What was asked for last.
  std::shared_ptr<const Recording> recording_;
  int frame_ = -1;
  Vec3d gravity_ = Vec3d::Zero();
  Worker frames_;  // last: its thread uses all of the above
};

}  // namespace planescope::desktop
