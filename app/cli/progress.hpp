#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "core/model/error.hpp"

namespace planescope::app {

/// A bar on stderr, only where that is a terminal; gone again when it is destroyed.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(int done, const std::string& now);
  /// A line that stays, above the bar; without a terminal too.
  void print(const std::string& line);

 private:
  std::string what_;
  int total_;
  bool visible_;
};

/// A measurement's progress(): shows a bar that ends with it, and throws Cancelled on stop.
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

/// Likewise of work in stages, a bar each. Does not stop anything.
class StageBar {
 public:
  explicit StageBar(std::string what) : what_(std::move(what)) {}
  void operator()(const char* stage, int done, int all) {
    if (!bar_ || shown_ != stage) {
      bar_.reset();  // before the next one is there
      bar_ = std::make_shared<Progress>(what_ + ": " + stage, all);
    }
    shown_ = stage;
    bar_->show(done, "");
  }

 private:
  std::string what_, shown_;
  std::shared_ptr<Progress> bar_;
};

}  // namespace planescope::app
