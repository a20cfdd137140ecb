#include "core/model/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

namespace planescope {
namespace {

TEST(Team, SharesAreConsecutiveAndCoverEverything) {
  for (const int threads : {1, 2, 5}) {
    std::vector<int> touched(103, 0);
    run_team(threads, [&](TeamMember& member) {
      const auto [begin, end] = member.share(touched.size());
      for (std::size_t i = begin; i < end; ++i) ++touched[i];
    });
    EXPECT_EQ(touched, std::vector<int>(103, 1)) << threads << " threads";
  }
}

TEST(Team, WhatWasWrittenBeforeAMeetingIsThereAfterIt) {
  std::vector<int> first(64, 0), second(64, 0);
  run_team(4, [&](TeamMember& member) {
    const auto [begin, end] = member.share(first.size());
    for (std::size_t i = begin; i < end; ++i) first[i] = static_cast<int>(i);
    member.meet();
    for (std::size_t i = begin; i < end; ++i) second[i] = first[63 - i];
  });
  for (int i = 0; i < 64; ++i) EXPECT_EQ(second[i], 63 - i);
}

TEST(Team, AnExceptionOfOneIsRethrownWhenTheOthersAreThrough) {
  std::atomic<int> through = 0;
  EXPECT_THROW(run_team(3,
                        [&](TeamMember& member) {
                          if (member.rank() == 1) throw std::runtime_error("one");
                          member.meet();
                          member.meet();
                          ++through;
                        }),
               std::runtime_error);
  EXPECT_EQ(through, 2);
}

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
