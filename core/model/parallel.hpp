#pragma once

// Threads and instruction sets.

#include <barrier>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

namespace planescope {

/// Calls body(begin, end) on consecutive chunks that cover [0, count), on up to `threads` threads.
/// Chunks depend on `threads`: write only data of the body's own indices, so that the result is the
/// same for any thread count. Rethrows exceptions of the body.
void parallel_for(std::size_t count,
                  int threads,
                  const std::function<void(std::size_t, std::size_t)>& body,
                  std::size_t min_chunk = 256);

/// Calls body(i) once for every i in [0, count) on up to `threads` threads; a free thread takes
/// the next index. For work items of unequal length. `progress(done, count)` is called on the
/// caller's thread; it may be empty and may throw to stop. An exception of the body stops the rest
/// and is rethrown.
void work_through(int count,
                  int threads,
                  const std::function<void(int)>& body,
                  const std::function<void(int, int)>& progress = {});

/// Same, with a separate body per thread, created and destroyed on that thread.
void work_through_with(int count,
                       int threads,
                       const std::function<std::function<void(int)>()>& make_body,
                       const std::function<void(int, int)>& progress = {});

/// Calls make(0), make(1), ... on up to `threads` threads, and take(0), take(1), ... on the
/// caller's thread, each after its make() and in order. For frames that are processed in parallel
/// but written in sequence. make() is at most twice the number of threads ahead of take(). An
/// exception of make(i) is rethrown when take(i) is due, an exception of take() immediately; both
/// stop the rest.
void work_in_order(int count,
                   int threads,
                   const std::function<void(int)>& make,
                   const std::function<void(int)>& take);

/// One of the threads that execute the phases of a computation together.
class TeamMember {
 public:
  TeamMember(int rank, int size, std::barrier<>& barrier)
      : rank_(rank), size_(size), barrier_(barrier) {}

  /// This member's part of [0, count): contiguous, in rank order.
  std::pair<std::size_t, std::size_t> share(std::size_t count) const {
    return {count * rank_ / size_, count * (rank_ + 1) / size_};
  }
  /// Waits for all members; their earlier writes are then visible.
  void meet() { barrier_.arrive_and_wait(); }
  int rank() const { return static_cast<int>(rank_); }

 private:
  std::size_t rank_, size_;
  std::barrier<>& barrier_;
};

/// Calls body on `threads` threads, including the calling one, and waits for all. Faster than one
/// parallel_for per phase if phases are short. An exception of `body` is rethrown after the other
/// members have finished without that one.
void run_team(int threads, const std::function<void(TeamMember&)>& body);

/// Instruction sets for which the hot loops are compiled; all give identical bits.
enum class Simd { plain, avx2, avx512 };

/// The widest set supported by this processor, or the one in the environment variable
/// PLANESCOPE_SIMD=plain|avx2|avx512. Throws Error if the variable is invalid or the processor does
/// not support it.
Simd best_simd();
std::string to_string(Simd simd);

}  // namespace planescope
