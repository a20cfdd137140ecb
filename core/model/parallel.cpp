#include "core/model/parallel.hpp"

#include <algorithm>
#include <exception>
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
    for (std::size_t i = 1; i < n; ++i) workers.emplace_back(run, i);
    run(0);
  }
  for (const auto& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace planescope
