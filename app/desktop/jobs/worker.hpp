#pragma once

// A thread that does one piece of work after the other and forgets what is no longer wanted.

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "core/model/error.hpp"

namespace planescope::desktop {

class Worker {
 public:
  using Work = std::function<void(std::stop_token)>;

  /// `rested`: called from the thread after each piece of work, when busy() no longer counts it.
  /// `failed`: before that, with what is to be told where the work threw.
  Worker(std::function<void()> rested, std::function<void(const std::string&)> failed)
      : rested_(std::move(rested)),
        failed_(std::move(failed)),
        thread_([this](std::stop_token stop) { loop(stop); }) {}
  ~Worker() {
    cancel();
    thread_.request_stop();
    wake_.notify_all();
  }

  /// Replaces whatever is waiting; the work in progress goes on.
  void replace(Work work) {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    waiting_.push_back(std::move(work));
    wake_.notify_all();
  }
  /// Asks the work in progress to stop, and drops what is waiting.
  void cancel() {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    current_.request_stop();
  }
  bool busy() const {
    const std::lock_guard lock(mutex_);
    return working_ || !waiting_.empty();
  }

 private:
  void loop(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    while (wake_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
      const Work work = std::move(waiting_.front());
      waiting_.pop_front();
      working_ = true;
      current_ = std::stop_source();
      const std::stop_token token = current_.get_token();
      lock.unlock();
      try {
        work(token);
      } catch (const std::exception& error) {
        failed_(message_of(error));
      }
      lock.lock();
      working_ = false;
      lock.unlock();
      rested_();
      lock.lock();
    }
  }

  std::function<void()> rested_;
  std::function<void(const std::string&)> failed_;
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<Work> waiting_;
  std::stop_source current_;
  bool working_ = false;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace planescope::desktop
