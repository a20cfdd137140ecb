#pragma once

#include <stop_token>
#include <thread>

namespace planescope::app {

/// Turns the first SIGINT or SIGTERM into a stop request, so that work ends at the next frame with
/// valid output. A second one ends the program at once. One per process.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  int pipe_[2] = {-1, -1};
  std::thread watcher_;
};

}  // namespace planescope::app
