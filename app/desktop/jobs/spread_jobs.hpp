#pragma once

// Labels of one frame proposed in all others that see its planes, in the background.

#include <functional>
#include <memory>
#include <vector>

#include "app/desktop/jobs/worker.hpp"
#include "app/desktop/state/state.hpp"
#include "core/labels/review/spread.hpp"

namespace planescope::desktop {

class SpreadJobs {
 public:
  /// As LabelJobs.
  SpreadJobs(std::function<void(std::function<void(State&)>)> deliver, std::function<void()> wake);
  ~SpreadJobs();

  void pursue(State& state);
  bool busy() const { return worker_.busy(); }

 private:
  void finish(int number, std::function<void(State&)> with);

  std::function<void(std::function<void(State&)>)> deliver_;
  // Touched by the window's thread only.
  bool asked_ = false;
  int number_ = 0;  // of the latest; what an earlier one still delivers is dropped
  Worker worker_;   // last: its thread uses all of the above
};

}  // namespace planescope::desktop
