#pragma once

// What of the processor is used: threads, and instruction sets.

#include <barrier>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

namespace planescope {

/// Calls body(begin, end) on consecutive chunks that cover [0, count), on up to `threads` threads.
/// The chunking depends on `threads`, so a body must write only what belongs to its own indices:
/// then the result is the same for any thread count. Exceptions of a body are rethrown here.
void parallel_for(std::size_t count,
                  int threads,
                  const std::function<void(std::size_t, std::size_t)>& body,
                  std::size_t min_chunk = 256);

/// Calls body(i) once for every i of [0, count) on up to `threads` threads, whichever is free
/// taking the next: for pieces of work of unequal length. `progress(done, count)` is called on the
/// caller's thread; it may be empty and may throw to stop. Exceptions of a body stop the rest and
/// are rethrown here.
void work_through(int count,
                  int threads,
                  const std::function<void(int)>& body,
                  const std::function<void(int, int)>& progress = {});

/// As above, each thread with a body of its own, made on that thread and gone with it.
void work_through_with(int count,
                       int threads,
                       const std::function<std::function<void(int)>()>& make_body,
                       const std::function<void(int, int)>& progress = {});

/// make(0), make(1), ... on up to `threads` threads, and take(0), take(1), ... on the caller's,
/// each after its own make() and in this order: for frames that are worked on side by side and
/// written one after the other. No make() runs further ahead than twice as many as there are
/// threads. An exception of make(i) is rethrown here in the place of take(i), one of take() as it
/// is; both stop the rest.
void work_in_order(int count,
                   int threads,
                   const std::function<void(int)>& make,
                   const std::function<void(int)>& take);

/// One of the threads that go through the phases of a computation together.
class TeamMember {
 public:
  TeamMember(int rank, int size, std::barrier<>& barrier)
      : rank_(rank), size_(size), barrier_(barrier) {}

  /// This member's part of [0, count): consecutive, in the order of the ranks.
  std::pair<std::size_t, std::size_t> share(std::size_t count) const {
    return {count * rank_ / size_, count * (rank_ + 1) / size_};
  }
  /// Waits until all members are here: what they wrote before can be read after.
  void meet() { barrier_.arrive_and_wait(); }
  int rank() const { return static_cast<int>(rank_); }

 private:
  std::size_t rank_, size_;
  std::barrier<>& barrier_;
};

/// Calls body on `threads` threads, this one among them, and waits for all. Quicker than one
/// parallel_for per phase where phases are short. An exception of `body` is rethrown here, when the
/// others have gone through without that member.
void run_team(int threads, const std::function<void(TeamMember&)>& body);

/// Instruction sets that the hot loops are compiled for, each giving the same bits.
enum class Simd { plain, avx2, avx512 };

/// The widest that this processor runs, or less where PLANESCOPE_SIMD=plain|avx2|avx512 is in the
/// environment. Throws Error where that names none of them or more than the processor has.
Simd best_simd();
std::string to_string(Simd simd);

}  // namespace planescope
