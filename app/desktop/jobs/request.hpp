#pragma once

// Background work by request: the state says what is wanted, as a key; a request begins the work
// when the key changes, and drops what is still delivered for an earlier one.

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

/// A change of the state that a job hands in.
using Delivery = std::function<void(State&)>;

/// Carries deliveries from any thread to the window's.
class Courier {
 public:
  /// `wake`: called from other threads whenever there is something to collect.
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
  /// `stop` is called before anything waits for the work that is under way.
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

/// A thread that does one piece of work after the other and forgets what is no longer wanted.
class Worker {
 public:
  using Work = std::function<void(std::stop_token)>;

  /// `rested`: called from the thread after each piece of work, when busy() no longer counts it.
  explicit Worker(std::function<void()> rested)
      : rested_(std::move(rested)), thread_([this](std::stop_token stop) { loop(stop); }) {}
  ~Worker() {
    cancel();
    thread_.request_stop();
    wake_.notify_all();
  }

  /// Replaces whatever is waiting; the work in progress goes on. It throws nothing.
  void replace(Work work) {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(work);
    wake_.notify_all();
  }
  /// Asks the work in progress to stop, and drops what is waiting.
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
  std::jthread thread_;  // last: it uses all of the above
};

/// What a piece of work is given.
struct Turn {
  std::stop_token stop;
  std::function<void(Delivery)> deliver;  // to the window's thread, unless it comes too late

  /// Throws Cancelled where the work is no longer wanted.
  void expect_wanted() const {
    if (stop.stop_requested()) throw Cancelled();
  }
  /// Shows how much of it is done.
  void progress(Asked& (*of)(State&), int done, int total, const std::string& stage = {}) const {
    deliver([=](State& state) {
      Asked& asked = of(state);
      asked.done = done;
      asked.total = total;
      asked.stage = stage;
    });
  }
};

/// Work of one kind, one piece at a time. All but the work itself runs in the window's thread.
template <typename Key>
class Request {
 public:
  /// What becomes of deliveries for an earlier key.
  enum class Late : std::uint8_t { dropped, taken };
  using Work = std::function<void(const Turn&)>;
  using Failed = std::function<void(State&, const std::string& why)>;

  explicit Request(Courier& courier, Late late = Late::dropped)
      : courier_(courier), late_(late), worker_([&courier] { courier.wake(); }) {
    courier.at_end([this] { stop(); });
  }
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;

  /// The key asked for last; nothing before the first, and once it was dropped.
  const std::optional<Key>& key() const { return key_; }
  /// Begins the work for a key. Where it throws, `failed` is called with the reason; by default the
  /// status bar shows it. Work that was cancelled is not reported.
  void ask(Key key, Work work, Failed failed = tell) {
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
  /// Whether what the state asks for is to begin now. What was called off is dropped.
  bool begins(Asked& asked, bool possible = true) {
    if (key_ && !asked.running) drop();
    if (!asked.running || asked.begun || !possible) return false;
    return asked.begun = true;
  }
  /// Stops the work in progress; its key stays.
  void stop() { worker_.cancel(); }
  /// The same, and drops its key and what it still delivers.
  void drop() {
    worker_.cancel();
    key_.reset();
    pending_ = false;
    ++number_;
  }
  /// Not everything was delivered yet that was asked for last.
  bool pending() const { return pending_; }
  /// Something is under way, whoever asked for it.
  bool busy() const { return worker_.busy(); }

 private:
  static void tell(State& state, const std::string& why) { say(state, why, true); }

  Courier& courier_;
  Late late_;
  std::optional<Key> key_;
  bool pending_ = false;
  int number_ = 0;  // of the latest
  Worker worker_;   // last: its thread uses all of the above
};

/// Jobs of one subject.
class JobGroup {
 public:
  virtual ~JobGroup() = default;
  /// Begins what the state wants and nobody works on yet.
  virtual void pursue(State& state) = 0;
  /// `background`: also what only fills the frame strip and the sliders.
  virtual bool busy(bool background) const = 0;
};

}  // namespace planescope::desktop
