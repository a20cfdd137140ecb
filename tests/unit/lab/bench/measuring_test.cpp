#include "core/lab/bench/measuring.hpp"

#include <gtest/gtest.h>

namespace planescope::lab {
namespace {

TEST(Statistics, TheMedianIsTheMiddleOrTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median({7}), 7);
  EXPECT_EQ(median({9, 1, 5}), 5);
  EXPECT_EQ(median({4, 1, 100, 2}), 3);
  EXPECT_EQ(median({2, 2, 1, 2}), 2);
}

TEST(Statistics, OfSeveralRunsTheMiddleAndBothEndsAreTold) {
  const Times times = times_of({9, 1, 5});
  EXPECT_EQ(times.median, 5);
  EXPECT_EQ(times.least, 1);
  EXPECT_EQ(times.greatest, 9);
}

TEST(Statistics, RatiosAreTakenBetweenWhatWasMeasuredSideBySide) {
  // Twice as long in every round, though the machine was slow in one of them.
  EXPECT_EQ(median_ratio(std::vector<double>{2, 20, 6}, std::vector<double>{1, 10, 3}), 2);
}

TEST(Clocks, AreThoseOfTheWallTheThreadAndTheProcess) {
  for (const Clock clock : {Clock::wall, Clock::thread_cpu, Clock::process_cpu}) {
    bool ran = false;
    EXPECT_GE(spent_ms(clock, [&] { ran = true; }), 0) << to_string(clock);
    EXPECT_TRUE(ran);
  }
}

TEST(Interleaved, EveryRoundRunsEachContestantOnceAndTheFirstDoesNotCount) {
  std::vector<int> runs(3), first_of_round;
  int turn = 0;
  const auto ms = interleaved_ms(
      3, 5, [] {},
      [&](std::size_t who, int) {
        ++runs[who];
        if (turn++ % 3 == 0) first_of_round.push_back(static_cast<int>(who));
      });
  EXPECT_EQ(runs, (std::vector{6, 6, 6}));
  EXPECT_EQ(first_of_round, (std::vector{0, 1, 2, 0, 1, 2}));
  ASSERT_EQ(ms.size(), 3u);
  for (const auto& of_one : ms) EXPECT_EQ(of_one.size(), 5u);
}

}  // namespace
}  // namespace planescope::lab
