#include "core/model/team.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
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

}  // namespace
}  // namespace planescope
