#include "core/lab/bench/interleaved.hpp"

#include <chrono>

namespace planescope::lab {

std::vector<std::vector<double>> interleaved_ms(std::size_t contestants,
                                                int rounds,
                                                const std::function<void()>& before,
                                                const std::function<void(std::size_t, int)>& body) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<double>> spent(contestants);
  for (int round = -1; round < rounds; ++round) {
    const auto number = static_cast<std::size_t>(round + 1);
    for (std::size_t turn = 0; turn < contestants; ++turn) {
      const std::size_t contestant = (number + turn) % contestants;
      before();
      const auto started = Clock::now();
      body(contestant, std::max(round, 0));
      const std::chrono::duration<double, std::milli> taken = Clock::now() - started;
      if (round >= 0) spent[contestant].push_back(taken.count());
    }
  }
  return spent;
}

}  // namespace planescope::lab
