#include "core/base/team.hpp"

#include <algorithm>
#include <thread>
#include <vector>

namespace planescope {

void run_team(int threads, const std::function<void(TeamMember&)>& body) {
  const int size = std::max(1, threads);
  std::barrier<> barrier(size);
  const auto run = [&](int rank) noexcept {
    TeamMember member(rank, size, barrier);
    body(member);
  };
  std::vector<std::jthread> others;
  others.reserve(static_cast<std::size_t>(size - 1));
  for (int rank = 1; rank < size; ++rank) others.emplace_back(run, rank);
  run(0);
}

}  // namespace planescope
