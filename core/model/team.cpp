#include "core/model/team.hpp"

#include <algorithm>
#include <exception>
#include <latch>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

namespace planescope {

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
