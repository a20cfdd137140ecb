// Tests of parallel work: teams, work lists and ordered results.

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

TEST(Team, WritesBeforeABarrierAreVisibleAfterIt) {
  std::vector<int> first(64, 0), second(64, 0);
  run_team(4, [&](TeamMember& member) {
    const auto [begin, end] = member.share(first.size());
    for (std::size_t i = begin; i < end; ++i) first[i] = static_cast<int>(i);
    member.meet();
    for (std::size_t i = begin; i < end; ++i) second[i] = first[63 - i];
  });
  for (int i = 0; i < 64; ++i) EXPECT_EQ(second[i], 63 - i);
}

TEST(Team, AnExceptionIsRethrownWhenTheOthersHaveFinished) {
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

TEST(WorkList, ProgressIsReportedOnTheCallersThread) {
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

TEST(InOrder, EverythingIsProducedOnceAndConsumedInOrderOnTheCallersThread) {
  const auto caller = std::this_thread::get_id();
  for (const int threads : {0, 1, 3, 100}) {
    std::vector<int> made(50, 0), taken;
    const auto make = [&](int i) { made[i] += i + 1; };
    const auto take = [&](int i) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      EXPECT_EQ(made[i], i + 1);
      taken.push_back(i);
    };
    work_in_order(50, threads, make, take);
    std::vector<int> all(50);
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(taken, all) << threads << " threads";
  }
}

TEST(InOrder, ProductionDoesNotRunFarAheadOfConsumption) {
  std::atomic<int> taken = 0;
  const auto make = [&](int i) { EXPECT_LE(i, taken + 6); };
  work_in_order(200, 3, make, [&](int) { ++taken; });
  EXPECT_EQ(taken, 200);
}

TEST(InOrder, TheFirstErrorInOrderIsReportedAfterConsumingEarlierItems) {
  for (const int threads : {1, 4}) {
    std::vector<int> taken;
    const auto make = [](int i) {
      if (i == 7 || i == 9) throw std::runtime_error(std::to_string(i));
    };
    try {
      work_in_order(1000, threads, make, [&](int i) { taken.push_back(i); });
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "7");
    }
    EXPECT_EQ(taken.size(), 7u);
  }
}

TEST(InOrder, AnErrorOfTheConsumerStopsTheRest) {
  std::atomic<int> made = 0;
  EXPECT_THROW(work_in_order(
                   1000, 2, [&](int) { ++made; }, [](int) { throw std::runtime_error("full"); }),
               std::runtime_error);
  EXPECT_LT(made, 1000);
}

}  // namespace
}  // namespace planescope
