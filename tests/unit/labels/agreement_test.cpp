#include <gtest/gtest.h>

#include "core/labels/review/review.hpp"

namespace planescope::labels {
namespace {

/// One row of pixels with these planes.
FrameLabels row(const std::vector<int>& planes) {
  FrameLabels labels;
  labels.plane = Image16(static_cast<int>(planes.size()), 1);
  labels.hv = Image8(static_cast<int>(planes.size()), 1);
  labels.plane.data.assign(planes.begin(), planes.end());
  return labels;
}

double rand_index(const std::vector<int>& a, const std::vector<int>& b) {
  return agreement_of(row(a), row(b)).adjusted_rand;
}

TEST(Agreements, TheAdjustedRandIndexIsAsComputedByHand) {
  EXPECT_DOUBLE_EQ(rand_index({1, 1, 2, 2}, {7, 7, 3, 3}), 1);
  EXPECT_NEAR(rand_index({1, 1, 2, 2}, {1, 1, 2, 3}), 4.0 / 7, 1e-12);
  EXPECT_NEAR(rand_index({1, 1, 1, 1}, {1, 2, 3, 4}), 0, 1e-12);
  EXPECT_NEAR(rand_index({1, 1, 2, 2}, {1, 2, 1, 2}), -0.5, 1e-12);
  // Shared pixels 5 1 0 / 1 4 1 / 2 0 3: 20 pairs in both, 40 and 44 in either, of 136.
  EXPECT_NEAR(rand_index({1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3},
                         {1, 1, 1, 1, 1, 2, 1, 2, 2, 2, 2, 3, 1, 1, 3, 3, 3}),
              (20 - 40.0 * 44 / 136) / (42 - 40.0 * 44 / 136), 1e-12);
  // Pixels without a plane in either do not count.
  EXPECT_NEAR(rand_index({1, 1, 2, 2, 0, 5}, {1, 1, 2, 3, 4, 0}), 4.0 / 7, 1e-12);
}

TEST(Agreements, TheSameLabelsUnderOtherNumbersAgreeFully) {
  FrameLabels a = row({1, 1, 1, 2, 2, 0, kPlaneIgnore}), b = row({9, 9, 9, 4, 4, 0, 4});
  a.hv.data = b.hv.data = {1, 1, 1, 2, 2, 0, kHvIgnore};
  const Agreement agreement = agreement_of(a, b);
  EXPECT_EQ(agreement.mean_iou, 1);
  EXPECT_EQ(agreement.adjusted_rand, 1);
  EXPECT_EQ(agreement.label_accuracy, 1);
  EXPECT_EQ(agreement.pixel_agreement, 1);
  EXPECT_EQ(agreement.matched, 2);
  EXPECT_EQ(agreement.pixels, 6u);
}

TEST(Agreements, FiguresOfAPartialAgreementAreAsComputedByHand) {
  FrameLabels a = row({1, 1, 1, 1, 2, 2, 2, 2, 3, 0}), b = row({1, 1, 1, 2, 2, 2, 2, 0, 0, 5});
  a.hv.data = {1, 1, 1, 1, 2, 2, 2, 2, 1, 0};
  b.hv.data = {1, 1, 2, 2, 2, 2, 2, 0, 0, 1};
  const Agreement agreement = agreement_of(a, b);
  EXPECT_EQ(agreement.planes_a, 3);
  EXPECT_EQ(agreement.planes_b, 3);
  EXPECT_EQ(agreement.matched, 2);
  EXPECT_NEAR(agreement.mean_iou, (3.0 / 4 + 3.0 / 5) / 4, 1e-12);
  EXPECT_NEAR(agreement.pixel_agreement, 6.0 / 10, 1e-12);
  EXPECT_NEAR(agreement.label_accuracy, 5.0 / 7, 1e-12);
  EXPECT_EQ(agreement.pixels, 10u);
}

TEST(Agreements, TwoFramesWithoutLabelsAgree) {
  const Agreement agreement = agreement_of(row({0, 0}), row({0, 0}));
  EXPECT_EQ(agreement.mean_iou, 1);
  EXPECT_EQ(agreement.adjusted_rand, 1);
}

}  // namespace
}  // namespace planescope::labels
