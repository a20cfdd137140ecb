#pragma once

// What the label mode does not wait for: making a frame ready, the review's queue, checks, carrying
// labels on.

#include <functional>
#include <memory>
#include <string>

#include "app/desktop/jobs/worker.hpp"
#include "app/desktop/labeling/review.hpp"
#include "app/desktop/state/state.hpp"

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
  void pursue_marks(State& state);
  void pursue_review(State& state);
  void pursue_audit(State& state);
  void stop_unwanted_carry(const State& state);
  void pursue_carry(State& state);
  void deliver_carried(State& state,
                       int number,
                       const std::shared_ptr<const FrameLabels>& existing,
                       const std::shared_ptr<const labels::CarriedLabels>& carried);

  std::function<void(std::function<void(State&)>)> deliver_;
  std::function<void(const std::string&)> failed_;  // tells why a piece of work threw
  // What was asked for last; touched by the window's thread only.
  std::shared_ptr<const io::Recording> recording_, marked_;
  int frame_ = -1;
  Vec3d gravity_ = Vec3d::Zero();
  ReviewSides reviewed_;
  std::shared_ptr<const FrameLabels> audited_;
  bool reviewing_ = false, auditing_ = false, carrying_ = false;  // not handed in yet
  int carry_number_ = 0;  // what an earlier one still delivers is dropped
  Worker frames_, marks_, reviews_, audits_, carries_;  // last: their threads use all of the above
};

}  // namespace planescope::desktop
