#pragma once

// Progress bars on a terminal, and loops over frames that show them.

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/model/error.hpp"
#include "core/model/parallel.hpp"

namespace planescope::app {

/// A progress bar on stderr, shown only on a terminal and erased by the destructor.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(int done, const std::string& now);
  /// Prints a permanent line above the bar, also without a terminal.
  void print(const std::string& line);

 private:
  std::string what_;
  int total_;
  bool visible_;
};

/// Progress callback of a measurement: shows a bar and throws Cancelled on stop.
class Bar {
 public:
  Bar(const char* what, std::stop_token stop) : what_(what), stop_(std::move(stop)) {}
  void operator()(int done, int all) {
    if (stop_.stop_requested()) throw Cancelled();
    if (!bar_) bar_ = std::make_shared<Progress>(what_, all);
    bar_->show(done, "");
  }

 private:
  const char* what_;
  std::stop_token stop_;
  std::shared_ptr<Progress> bar_;
};

/// Progress callback of work in stages, with one bar per stage. Ignores stop requests.
class StageBar {
 public:
  explicit StageBar(std::string what) : what_(std::move(what)) {}
  void operator()(const char* stage, int done, int all) {
    if (!bar_ || shown_ != stage) {
      bar_.reset();  // erase it before the next bar appears
      bar_ = std::make_shared<Progress>(what_ + ": " + stage, all);
    }
    shown_ = stage;
    bar_->show(done, "");
  }

 private:
  std::string what_, shown_;
  std::shared_ptr<Progress> bar_;
};

/// Calls work(frame) for each frame in order. Throws Cancelled on stop.
template <typename Work>
void for_each_frame(const char* what,
                    const std::vector<int>& frames,
                    const std::stop_token& stop,
                    Work&& work) {
  Progress progress(what, static_cast<int>(frames.size()));
  int done = 0;
  for (const int frame : frames) {
    if (stop.stop_requested()) throw Cancelled();
    progress.show(done++, fmt::format("frame {}", frame));
    work(frame);
  }
}

/// Calls made = make(i) on `threads` threads, and take(i, made) in frame order. After a stop
/// request, make() is not called again.
template <typename Make, typename Take>
void run_frames(const char* what,
                const std::vector<int>& frames,
                int threads,
                const std::stop_token& stop,
                Make&& make,
                Take&& take) {
  std::vector<std::optional<decltype(make(std::size_t{0}))>> made(frames.size());
  Progress progress(what, static_cast<int>(frames.size()));
  work_in_order(
      static_cast<int>(frames.size()), threads,
      [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        if (!stop.stop_requested()) made[at] = make(at);
      },
      [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        progress.show(i + 1, fmt::format("frame {}", frames[at]));
        if (made[at]) take(at, std::move(*made[at]));
        made[at].reset();
      });
}

}  // namespace planescope::app
