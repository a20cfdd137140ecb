#include "core/model/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <latch>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

namespace planescope {

void parallel_for(std::size_t count,
                  int threads,
                  const std::function<void(std::size_t, std::size_t)>& body,
                  std::size_t min_chunk) {
  const std::size_t useful = std::max<std::size_t>(1, count / std::max<std::size_t>(1, min_chunk));
  const std::size_t n =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::max(1, threads)), 1, useful);
  if (n == 1) {
    if (count > 0) body(0, count);
    return;
  }
  std::vector<std::exception_ptr> errors(n);
  const auto run = [&](std::size_t i) {
    try {
      body(count * i / n, count * (i + 1) / n);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> workers;
    workers.reserve(n - 1);
    std::size_t started = 1;
    try {
      for (; started < n; ++started) workers.emplace_back(run, started);
    } catch (const std::system_error&) {  // no more threads: this one does the rest
    }
    run(0);
    for (std::size_t i = started; i < n; ++i) run(i);
  }
  for (const auto& error : errors)
    if (error) std::rethrow_exception(error);
}

void work_through_with(int count,
                       int threads,
                       const std::function<std::function<void(int)>()>& make_body,
                       const std::function<void(int, int)>& progress) {
  std::atomic<int> next = 0, done = 0;
  const auto work = [&](std::size_t first_worker, std::size_t) {
    try {
      const std::function<void(int)> body = make_body();
      for (int i = next++; i < count; i = next++) {
        body(i);
        ++done;
        if (progress && first_worker == 0) progress(done, count);
      }
    } catch (...) {
      next = count;
      throw;
    }
  };
  const auto workers = static_cast<std::size_t>(std::clamp(threads, 1, std::max(1, count)));
  parallel_for(workers, static_cast<int>(workers), work, 1);
}

void work_through(int count,
                  int threads,
                  const std::function<void(int)>& body,
                  const std::function<void(int, int)>& progress) {
  work_through_with(
      count, threads, [&body] { return body; }, progress);
}

namespace {

/// What work_in_order() has made and not yet taken.
class Line {
 public:
  Line(int count, int ahead, const std::function<void(int)>& make)
      : make_(make), made_(count), errors_(count), ahead_(ahead) {}

  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return next_ >= end() || next_ < taken_ + ahead_; });
      if (next_ >= end()) return;
      const int i = next_++;
      lock.unlock();
      try {
        make_(i);
      } catch (...) {
        errors_[i] = std::current_exception();
      }
      lock.lock();
      made_[i] = 1;
      changed_.notify_all();
    }
  }
  void take(int i, const std::function<void(int)>& taker) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return made_[i] != 0; });
    lock.unlock();
    if (errors_[i]) std::rethrow_exception(errors_[i]);
    taker(i);
    lock.lock();
    ++taken_;
    changed_.notify_all();
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    next_ = end();
    changed_.notify_all();
  }

 private:
  int end() const { return static_cast<int>(made_.size()); }

  const std::function<void(int)>& make_;
  std::vector<std::uint8_t> made_;
  std::vector<std::exception_ptr> errors_;
  int ahead_, next_ = 0, taken_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace

void work_in_order(int count,
                   int threads,
                   const std::function<void(int)>& make,
                   const std::function<void(int)>& take) {
  const int workers = std::min(threads, count);
  Line line(count, 2 * workers, make);
  std::vector<std::jthread> started;
  try {
    for (int i = 0; workers > 1 && i < workers; ++i) started.emplace_back([&] { line.work(); });
  } catch (const std::system_error&) {  // no more threads: those there are do the rest
  }
  if (started.empty()) {
    for (int i = 0; i < count; ++i) {
      make(i);
      take(i);
    }
    return;
  }
  try {
    for (int i = 0; i < count; ++i) line.take(i, take);
  } catch (...) {
    line.stop();
    throw;
  }
}

void run_team(int threads, const std::function<void(TeamMember&)>& body) {
  // Members wait until it is known how many there are: a system that has no more threads to give
  // makes the team smaller.
  std::latch complete(1);
  std::optional<std::barrier<>> barrier;
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(std::max(1, threads)));
  int size = 1;
  const auto run = [&](int rank) {
    complete.wait();
    TeamMember member(rank, size, *barrier);
    try {
      body(member);
    } catch (...) {
      errors[rank] = std::current_exception();
      barrier->arrive_and_drop();  // the others go on without this one
    }
  };
  {
    std::vector<std::jthread> others;
    others.reserve(errors.size() - 1);
    try {
      for (; size < threads; ++size) others.emplace_back(run, size);
    } catch (const std::system_error&) {
    }
    barrier.emplace(size);
    complete.count_down();
    run(0);
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace planescope
