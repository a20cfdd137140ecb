#include "core/model/work_list.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace planescope {
namespace {

TEST(WorkList, EveryPieceIsDoneOnceByAnyNumberOfThreads) {
  for (const int threads : {1, 3, 100}) {
    std::vector<std::atomic<int>> times(40);
    work_through(40, threads, [&](int i) { ++times[static_cast<std::size_t>(i)]; });
    for (const auto& count : times) EXPECT_EQ(count, 1);
  }
  work_through(0, 4, [](int) { FAIL(); });
}

TEST(WorkList, ProgressIsToldOnTheCallersThread) {
  const auto caller = std::this_thread::get_id();
  int last = 0;
  work_through(
      20, 1, [](int) {},
      [&](int done, int count) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        EXPECT_EQ(count, 20);
        EXPECT_EQ(done, ++last);
      });
  EXPECT_EQ(last, 20);
}

TEST(WorkList, AnExceptionStopsTheRest) {
  std::atomic<int> begun = 0;
  const auto body = [&](int i) {
    ++begun;
    if (i == 3) throw std::runtime_error("stop");
  };
  EXPECT_THROW(work_through(1000, 1, body), std::runtime_error);
  EXPECT_EQ(begun, 4);
}

}  // namespace
}  // namespace planescope
