#pragma once

// Runs with other options: the search for fixes, the check of one on all labeled frames, and the
// curves in the sliders. One at a time, a later one replaces an earlier one.

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "app/desktop/jobs/frame_work.hpp"
#include "app/desktop/jobs/worker.hpp"

namespace planescope::desktop {

class AnalysisJobs {
 public:
  /// As LabelJobs. `tools` outlives this.
  AnalysisJobs(std::function<void(std::function<void(State&)>)> deliver,
               std::function<void()> wake,
               FrameTools& tools);
  ~AnalysisJobs();

  /// `running`: a frame is being run; curves wait for it.
  void pursue(State& state, bool running);
  /// `background`: curves count, too.
  bool busy(bool background) const;

 private:
  enum class Kind : std::uint8_t { none, search, check, sensitivity };

  void pursue_fix(State& state);
  void pursue_sensitivity(State& state, bool running);
  void start(Kind what, std::function<void(std::stop_token, int number)> work);
  void stop();
  /// Drops what an analysis delivers that is not the latest.
  void deliver(int number, std::function<void(State&)> delivery);

  std::function<void(std::function<void(State&)>)> deliver_;
  FrameTools& tools_;
  // Touched by the window's thread only.
  Kind kind_ = Kind::none;
  int number_ = 0;
  std::shared_ptr<const RunView> swept_;  // whose curves are known
  Worker worker_;                         // last: its thread uses all of the above
};

}  // namespace planescope::desktop
