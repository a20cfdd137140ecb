#include "core/debug/explain/score.hpp"

#include <gtest/gtest.h>

namespace planescope::debug {
namespace {

VoxelTruth truth_of(std::vector<std::int32_t> planes, int count) {
  return {std::vector<std::uint8_t>(planes.size(), 1), std::move(planes), count};
}

TEST(QuickScore, SharesAreCountedOverVoxelsWithATruePlane) {
  const VoxelTruth truth = truth_of({1, 1, 1, 1, 2, 2, 0, -1}, 2);
  const std::vector<std::int32_t> found{1, 1, 1, 1, 0, 2, 2, 1};
  const QuickScore score = quick_score(found, truth);
  ASSERT_EQ(score.planes.size(), 2u);
  EXPECT_EQ(score.planes[0].found, 1);
  EXPECT_DOUBLE_EQ(score.planes[0].iou, 1) << "what is not scored counts nowhere";
  EXPECT_DOUBLE_EQ(score.planes[1].iou, 1.0 / 3);
  EXPECT_EQ(score.detected, 1);
  EXPECT_DOUBLE_EQ(score.mean_iou, (1 + 1.0 / 3) / 2);
  EXPECT_DOUBLE_EQ(score.in_no_plane, 1.0 / 6);
  EXPECT_EQ(score.found_planes, 2);
}

TEST(QuickScore, WithoutTruthOnlyThePlanesAreCounted) {
  const std::vector<std::int32_t> found{1, 0, 2};
  const QuickScore score = quick_score(found, {});
  EXPECT_TRUE(score.planes.empty());
  EXPECT_EQ(score.found_planes, 2);
}

TEST(QuickScore, EveryWayToLoseAPlaneHasItsName) {
  const auto verdict = [](const std::vector<std::int32_t>& found, std::int32_t plane) {
    const VoxelTruth truth = truth_of({1, 1, 1, 1, 2, 2, 2, 2}, 2);
    return verdicts_of(quick_score(found, truth), found, truth)[plane - 1];
  };
  EXPECT_EQ(verdict({1, 1, 1, 1, 2, 2, 2, 2}, 1), TruthVerdict::detected);
  EXPECT_EQ(verdict({1, 1, 1, 1, 1, 1, 1, 1}, 1), TruthVerdict::merged);
  EXPECT_EQ(verdict({1, 1, 3, 3, 2, 2, 2, 2}, 1), TruthVerdict::split);
  EXPECT_EQ(verdict({0, 0, 0, 1, 2, 2, 2, 2}, 1), TruthVerdict::missed);
  EXPECT_EQ(verdict({0, 0, 0, 0, 2, 2, 2, 2}, 1), TruthVerdict::missed);
}

}  // namespace
}  // namespace planescope::debug
