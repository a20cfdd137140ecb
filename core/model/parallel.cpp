// Parallel loops, teams of threads with barriers, and the SIMD level of the processor.

#include "core/model/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <latch>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "core/model/error.hpp"

namespace planescope {
namespace {

/// Calls run(1), run(2), ... on `count` new threads, or on as many as the system provides.
template <typename Run>
std::vector<std::jthread> start_threads(std::size_t count, const Run& run) {
  std::vector<std::jthread> threads;
  try {
    threads.reserve(count);
    while (threads.size() < count) threads.emplace_back(run, threads.size() + 1);
  } catch (const std::system_error&) {
  } catch (const std::bad_alloc&) {
  }
  return threads;
}

}  // namespace

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
    const std::vector<std::jthread> workers = start_threads(n - 1, run);
    run(0);
    for (std::size_t i = 1 + workers.size(); i < n; ++i) run(i);
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

/// Results of work_in_order() that have been made but not taken yet.
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
  const std::vector<std::jthread> started =
      start_threads(workers > 1 ? workers : 0, [&](std::size_t) { line.work(); });
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
  // Members wait until the team size is known: it is smaller if the system cannot provide
  // enough threads.
  std::latch complete(1);
  const int wanted = std::max(1, threads);
  std::barrier<> barrier(wanted);
  std::vector<std::exception_ptr> errors(wanted);
  int size = 1;
  const auto run = [&](std::size_t rank) {
    complete.wait();
    TeamMember member(static_cast<int>(rank), size, barrier);
    try {
      body(member);
    } catch (...) {
      errors[rank] = std::current_exception();
      barrier.arrive_and_drop();  // the others continue without this member
    }
  };
  {
    const std::vector<std::jthread> others = start_threads(wanted - 1, run);
    size += static_cast<int>(others.size());
    for (int missing = size; missing < wanted; ++missing) barrier.arrive_and_drop();
    complete.count_down();
    run(0);
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

namespace {

Simd widest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return Simd::avx512;
  if (__builtin_cpu_supports("avx2")) return Simd::avx2;
#endif
  return Simd::plain;
}

}  // namespace

Simd best_simd() {
  static const Simd kWidest = widest();
  const char* asked = std::getenv("PLANESCOPE_SIMD");
  if (!asked || !*asked) return kWidest;
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512}) {
    if (to_string(simd) != asked) continue;
    if (simd > kWidest)
      throw Error("PLANESCOPE_SIMD is " + to_string(simd) + ", but this processor supports only " +
                  to_string(kWidest));
    return simd;
  }
  throw Error("PLANESCOPE_SIMD is '" + std::string(asked) + "'; expected plain, avx2, or avx512");
}

std::string to_string(Simd simd) {
  switch (simd) {
    case Simd::avx2:
      return "avx2";
    case Simd::avx512:
      return "avx512";
    case Simd::plain:
      break;
  }
  return "plain";
}

}  // namespace planescope
