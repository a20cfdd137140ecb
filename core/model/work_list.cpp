#include "core/model/work_list.hpp"

#include <algorithm>
#include <atomic>

#include "core/model/parallel.hpp"

namespace planescope {

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

}  // namespace planescope
