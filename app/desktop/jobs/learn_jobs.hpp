#pragma once

// A classifier that learns from reviewed frames, in the background: its training, its measurement,
// and the doubt of the other frames.

#include <functional>
#include <memory>
#include <vector>

#include "app/desktop/jobs/frame_work.hpp"
#include "app/desktop/jobs/worker.hpp"
#include "app/desktop/labeling/learning.hpp"

namespace planescope::desktop {

class LearnJobs {
 public:
  /// As LabelJobs.
  LearnJobs(std::function<void(std::function<void(State&)>)> deliver, std::function<void()> wake);
  ~LearnJobs();

  void pursue(State& state);
  bool busy() const;

 private:
  void pursue_training(State& state);
  void pursue_measuring(State& state);
  void pursue_doubt(State& state);
  LearningProgress training_progress(int number, std::stop_token stop);

  std::function<void(std::function<void(State&)>)> deliver_;
  // What was asked for last; touched by the window's thread only.
  bool training_asked_ = false;
  int training_number_ = 0;  // what an earlier one still delivers is dropped
  int trainings_ = 0;        // that ended: their weights are to be measured
  struct Measured {
    std::shared_ptr<const io::Recording> recording;
    std::vector<int> reviewed;
    int trainings = -1;
    bool operator==(const Measured&) const = default;
  } measured_;
  std::optional<Wanted> doubted_;
  int doubt_number_ = 0;
  FrameTools tools_;
  Worker training_, measuring_, doubting_;  // last: their threads use all of the above
};

}  // namespace planescope::desktop
