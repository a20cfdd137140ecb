#pragma once

#include <barrier>
#include <cstddef>
#include <functional>
#include <utility>

namespace planescope {

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

}  // namespace planescope
