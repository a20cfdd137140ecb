#pragma once

// Work that the window does not wait for: reading frames, running them, thumbnails, searches. The
// state says what is wanted; pursue() starts what is missing, collect() hands over what is done.

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// A change of the state that a job hands in.
using Delivery = std::function<void(State&)>;

class Jobs {
 public:
  /// `wake`: called from other threads whenever there is something to collect.
  explicit Jobs(std::function<void()> wake);
  ~Jobs();  // cancels and waits
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  void pursue(State& state);
  /// True where the state has changed.
  bool collect(State& state);
  /// Something is under way whose result is not handed over yet. `background`: also what only fills
  /// the frame strip and sweeps the sliders.
  bool busy(bool background = true) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planescope::desktop
