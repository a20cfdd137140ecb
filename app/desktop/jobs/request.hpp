#pragma once

// Background work by request. The state describes wanted work as a key; a request starts the work
// when the key changes and drops late deliveries for earlier keys.

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/desktop/actions/actions.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {

/// A change to the state delivered by a job.
using Delivery = std::function<void(State&)>;

/// Passes deliveries from any thread to the window's thread.
class Courier {
 public:
  /// `wake` is called from other threads when there is something to collect.
  explicit Courier(std::function<void()> wake) : wake_(std::move(wake)) {}

  void wake() const { wake_(); }
  void deliver(Delivery delivery) {
    {
      const std::lock_guard lock(mutex_);
      waiting_.push_back(std::move(delivery));
    }
    wake_();
  }
  std::vector<Delivery> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(waiting_, {});
  }
  bool empty() const {
    const std::lock_guard lock(mutex_);
    return waiting_.empty();
  }
  /// `stop` is called on all jobs before waiting for any of them.
  void at_end(std::function<void()> stop) { stops_.push_back(std::move(stop)); }
  void end() {
    for (const auto& stop : stops_) stop();
  }

 private:
  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::vector<Delivery> waiting_;
  std::vector<std::function<void()>> stops_;
};

/// A thread that does one piece of work at a time and discards outdated work.
class Worker {
 public:
  using Work = std::function<void(std::stop_token)>;

  /// `rested` is called from the thread after each piece of work, when busy() no longer includes
  /// it.
  explicit Worker(std::function<void()> rested)
      : rested_(std::move(rested)), thread_([this](std::stop_token stop) { loop(stop); }) {}
  ~Worker() {
    cancel();
    thread_.request_stop();
    wake_.notify_all();
  }

  /// Replaces waiting work; the work in progress continues. `work` must not throw.
  void replace(Work work) {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(work);
    wake_.notify_all();
  }
  /// Requests the work in progress to stop and drops waiting work.
  void cancel() {
    const std::lock_guard lock(mutex_);
    waiting_ = nullptr;
    current_.request_stop();
  }
  bool busy() const {
    const std::lock_guard lock(mutex_);
    return working_ || waiting_;
  }

 private:
  void loop(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    while (wake_.wait(lock, stop, [this] { return waiting_ != nullptr; })) {
      const Work work = std::exchange(waiting_, nullptr);
      working_ = true;
      current_ = std::stop_source();
      const std::stop_token token = current_.get_token();
      lock.unlock();
      work(token);
      lock.lock();
      working_ = false;
      lock.unlock();
      rested_();
      lock.lock();
    }
  }

  std::function<void()> rested_;
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  Work waiting_;  // null: none
  std::stop_source current_;
  bool working_ = false;
  std::jthread thread_;  // last: it uses the members above
};

/// The context of a piece of work.
struct Turn {
  std::stop_token stop;
  std::function<void(Delivery)> deliver;  // to the window's thread, unless outdated

  /// Throws Cancelled if the work is no longer wanted.
  void expect_wanted() const {
    if (stop.stop_requested()) throw Cancelled();
  }
  /// Reports progress.
  void progress(Asked& (*of)(State&), int done, int total, const std::string& stage = {}) const {
    deliver([=](State& state) {
      Asked& asked = of(state);
      asked.done = done;
      asked.total = total;
      asked.stage = stage;
    });
  }
};

/// Work of one kind, one piece at a time. Everything except the work itself runs in the window's
/// thread.
template <typename Key>
class Request {
 public:
  /// Handling of deliveries for an earlier key.
  enum class Late : std::uint8_t { dropped, taken };
  using Work = std::function<void(const Turn&)>;
  using Failed = std::function<void(State&, const std::string& why)>;

  explicit Request(Courier& courier, Late late = Late::dropped)
      : courier_(courier), late_(late), worker_([&courier] { courier.wake(); }) {
    courier.at_end([this] { stop(); });
  }
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;

  /// The latest key; nullopt before the first and after drop().
  const std::optional<Key>& key() const { return key_; }
  /// Starts work for a key. If it throws, `failed` is called with the reason; by default the status
  /// bar shows it. Canceled work is not reported.
  void ask(Key key, Work work, Failed failed = show_error) {
    drop();
    key_ = std::move(key);
    pending_ = true;
    worker_.replace([this, number = number_, work = std::move(work),
                     failed = std::move(failed)](std::stop_token stop) {
      const auto deliver = [this, number](Delivery delivery) {
        courier_.deliver([this, number, delivery = std::move(delivery)](State& state) {
          if (number == number_ || late_ == Late::taken) delivery(state);
        });
      };
      try {
        work({stop, deliver});
      } catch (const Cancelled&) {
      } catch (const std::exception& error) {
        deliver([failed, why = message_of(error)](State& state) { failed(state, why); });
      }
      deliver([this, number](State&) {
        if (number == number_) pending_ = false;
      });
    });
  }
  /// Whether the requested work should start now. Drops work that is no longer requested.
  bool begins(Asked& asked, bool possible = true) {
    if (key_ && !asked.running) drop();
    if (!asked.running || asked.begun || !possible) return false;
    return asked.begun = true;
  }
  /// Stops the work in progress but keeps its key.
  void stop() { worker_.cancel(); }
  /// Stops the work, drops its key and its pending deliveries.
  void drop() {
    worker_.cancel();
    key_.reset();
    pending_ = false;
    ++number_;
  }
  /// Whether the latest work has not been delivered completely.
  bool pending() const { return pending_; }
  /// Whether any work is running.
  bool busy() const { return worker_.busy(); }

 private:
  static void show_error(State& state, const std::string& why) { say(state, why, true); }

  Courier& courier_;
  Late late_;
  std::optional<Key> key_;
  bool pending_ = false;
  int number_ = 0;  // number of the latest request
  Worker worker_;   // last: its thread uses the members above
};

/// Jobs on one topic.
class JobGroup {
 public:
  virtual ~JobGroup() = default;
  /// Starts wanted work that is not running yet.
  virtual void pursue(State& state) = 0;
  /// `background` includes work for the frame strip and the sliders' curves.
  virtual bool busy(bool background) const = 0;
};

}  // namespace planescope::desktop
