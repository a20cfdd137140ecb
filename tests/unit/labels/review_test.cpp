// Tests of disagreements between annotators, review decisions and agreement scores.

#include "core/labels/review/review.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/labels/edit/operations.hpp"
#include "core/model/error.hpp"
#include "core/model/random.hpp"
#include "small_frames.hpp"
#include "support/label_drafts.hpp"

namespace planescope::labels {
namespace {

/// A wall at 1 m, fully measured; each pixel is 1 cm2.
LabelGrid wall() {
  LabelGrid grid = test::wall_grid(64, 48);
  std::ranges::fill(grid.normals, Vec3f(0, 0, -1));  // exactly
  return grid;
}

constexpr double kPixelM2 = 1e-4;

/// P1 (v) on the left half and P2 (v) on the right, in the labels and from the algorithm.
struct Reviews : testing::Test {
  LabelGrid grid = wall();
  FrameLabels labels = empty_labels(grid, std::string(64, 'a'));
  OtherLabels other;

  Reviews() {
    put(0, 0, 32, 48, 1);
    put(32, 0, 64, 48, 2);
    labels.planes = {{.id = 1, .label = Label::v}, {.id = 2, .label = Label::v}};
    refit_planes(labels, grid);
    other = other_of(labels);
  }

  void put(int x1, int y1, int x2, int y2, int id) {
    for (const std::uint32_t i : test::rectangle(grid, x1, y1, x2, y2)) {
      labels.plane.data[i] = static_cast<std::uint16_t>(id);
      labels.hv.data[i] = id == 0 ? 0 : id == kPlaneIgnore ? kHvIgnore : 2;
    }
  }
  void put_other(int x1, int y1, int x2, int y2, int id) {
    for (const std::uint32_t i : test::rectangle(grid, x1, y1, x2, y2)) other.plane[i] = id;
  }
  std::vector<Disagreement> found() const { return find_disagreements(labels, other, grid); }

  /// Expects a single disagreement, of this kind and in this box.
  Disagreement only(DisagreementKind kind, int x1, int y1, int x2, int y2) const {
    const auto all = found();
    EXPECT_EQ(all.size(), 1u);
    if (all.size() != 1) return {};
    const PixelSet box = test::rectangle(grid, x1, y1, x2, y2);
    EXPECT_EQ(all[0].kind, kind);
    EXPECT_EQ(all[0].pixels, box);
    EXPECT_NEAR(all[0].area_m2, static_cast<double>(box.size()) * kPixelM2, 1e-9);
    return all[0];
  }
  FrameLabels take(const Disagreement& about) const {
    return edited(labels, grid, decide, grid, about, other, ReviewDecision::take, "bob", 77);
  }
};

TEST_F(Reviews, EqualLabelsHaveNoDisagreements) { EXPECT_TRUE(found().empty()); }

TEST_F(Reviews, AMissedRegionIsLabeledAndAcceptingTheOtherUnlabelsIt) {
  put_other(40, 10, 51, 21, 0);
  const auto region = only(DisagreementKind::missed, 40, 10, 51, 21);
  EXPECT_EQ(region.label_plane, 2);
  EXPECT_EQ(region.other_plane, 0);
  EXPECT_EQ(region.pixel, 15u * 64 + 45);
  EXPECT_EQ(take(region).plane.at(45, 15), 0);
}

TEST_F(Reviews, AnInventedRegionIsUnlabeledAndAcceptedIntoItsPlane) {
  put(5, 5, 12, 12, 0);
  const auto region = only(DisagreementKind::invented, 5, 5, 12, 12);
  EXPECT_EQ(take(region).plane.at(7, 7), 1);
}

TEST_F(Reviews, AnInventedSeparatePlaneIsAcceptedAsANewOne) {
  put(5, 5, 12, 12, 0);
  put_other(5, 5, 12, 12, 9);
  other.label.resize(9, Label::h);
  const FrameLabels taken = take(only(DisagreementKind::invented, 5, 5, 12, 12));
  EXPECT_EQ(taken.plane.at(7, 7), 3);
  ASSERT_TRUE(find_plane(taken, 3));
  EXPECT_EQ(find_plane(taken, 3)->label, Label::h);
  EXPECT_EQ(find_plane(taken, 3)->origin, LabelOrigin::algorithm);
}

TEST_F(Reviews, TheSmallerPartOfAPlaneSplitByTheOtherIsASplit) {
  put_other(0, 0, 10, 48, 3);
  other.label.resize(3, Label::v);
  const auto region = only(DisagreementKind::split, 0, 0, 10, 48);
  EXPECT_EQ(region.label_plane, 1);
  EXPECT_EQ(take(region).plane.at(3, 3), 3);
}

TEST_F(Reviews, APlaneThatExtendsOverAnotherIsAMerge) {
  put_other(32, 0, 45, 48, 1);
  const auto region = only(DisagreementKind::merged, 32, 0, 45, 48);
  EXPECT_EQ(region.label_plane, 2);
  EXPECT_EQ(region.other_plane, 1);
  EXPECT_EQ(take(region).plane.at(40, 3), 1);
}

TEST_F(Reviews, MatchedPlanesOfDifferentClassFlip) {
  other.label[1] = Label::h;
  const auto region = only(DisagreementKind::class_flip, 32, 0, 64, 48);
  const FrameLabels taken = take(region);
  EXPECT_EQ(find_plane(taken, 2)->label, Label::h);
  EXPECT_EQ(taken.hv.at(50, 3), 1);
  other.label[1] = Label::unknown;
  EXPECT_TRUE(found().empty());
}

TEST_F(Reviews, AThinStripIsABoundary) {
  put_other(32, 0, 35, 48, 1);
  only(DisagreementKind::boundary, 32, 0, 35, 48);
  put_other(35, 0, 36, 48, 1);
  only(DisagreementKind::merged, 32, 0, 36, 48);
}

TEST_F(Reviews, IgnoredUnmeasuredAndUnknownPixelsAreNotDisagreements) {
  put_other(40, 10, 60, 30, 0);
  put(40, 10, 60, 20, kPlaneIgnore);
  put_other(40, 20, 60, 25, -1);
  for (const std::uint32_t i : test::rectangle(grid, 40, 25, 60, 30)) grid.measured[i] = 0;
  EXPECT_TRUE(found().empty());
}

TEST_F(Reviews, SmallRegionsAreNotDisagreementsAndLargeOnesComeFirst) {
  put_other(2, 2, 4, 4, 0);
  put_other(40, 10, 45, 15, 0);
  put_other(50, 20, 60, 30, 0);
  const auto all = found();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].pixels.size(), 100u);
  EXPECT_EQ(all[1].pixels.size(), 25u);
}

TEST_F(Reviews, ADecidedRegionIsRecognizedAfterSmallChanges) {
  put_other(40, 10, 51, 21, 0);
  put_other(5, 5, 10, 10, 0);
  labels = edited(labels, grid, decide, grid, found()[0], other, ReviewDecision::keep, "bob",
                  1763750000);
  ASSERT_EQ(labels.review.size(), 1u);
  EXPECT_EQ(labels.review[0].reviewer, "bob");
  put_other(40, 10, 42, 21, 2);
  put_other(51, 12, 53, 18, 0);
  auto all = found();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_FALSE(all[0].note);  // the smaller one; undecided
  ASSERT_TRUE(all[1].note);
  EXPECT_EQ(all[1].note->decision, ReviewDecision::keep);
  EXPECT_EQ(all[1].note->time_s, 1763750000);

  labels =
      edited(labels, grid, decide, grid, all[1], other, ReviewDecision::edit, "carol", 1763750001);
  ASSERT_EQ(labels.review.size(), 1u);
  EXPECT_EQ(labels.review[0].reviewer, "carol");
  put_other(32, 0, 64, 48, 0);  // an unrelated disagreement
  all = found();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_FALSE(all[0].note);
  EXPECT_FALSE(all[1].note);
}

TEST_F(Reviews, KeepingAndEditingKeepTheLabelsAndIgnoringUnscoresThem) {
  put_other(40, 10, 51, 21, 0);
  const auto region = found()[0];
  for (const auto decision : {ReviewDecision::keep, ReviewDecision::edit}) {
    const auto after = edited(labels, grid, decide, grid, region, other, decision, "bob", 1);
    EXPECT_EQ(after.plane.data, labels.plane.data);
    EXPECT_EQ(after.review.size(), 1u);
  }
  const auto after =
      edited(labels, grid, decide, grid, region, other, ReviewDecision::ignore, "bob", 1);
  EXPECT_EQ(after.plane.at(45, 15), kPlaneIgnore);
  EXPECT_EQ(after.hv.at(45, 15), kHvIgnore);
  EXPECT_EQ(after.plane.at(39, 15), 2);
}

TEST_F(Reviews, AcceptingOrIgnoringLockedPlanesIsRejected) {
  put_other(40, 10, 51, 21, 0);
  labels.planes[1].locked = true;
  EXPECT_THROW(take(found()[0]), Error);
  EXPECT_THROW(
      edited(labels, grid, decide, grid, found()[0], other, ReviewDecision::ignore, "bob", 0),
      Error);
}

TEST_F(Reviews, AfterAcceptingEveryRegionNothingIsLeft) {
  Random random(3);
  other.label.resize(6, Label::h);
  for (int i = 0; i < 12; ++i) {
    const int x = random.integer(0, 52), y = random.integer(0, 36);
    put_other(x, y, x + random.integer(3, 12), y + random.integer(3, 12), random.integer(0, 6));
  }
  for (int i = 0; i < 100 && !found().empty(); ++i) labels = take(found()[0]);
  EXPECT_TRUE(found().empty());
}

/// One row of pixels with these plane ids.
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

TEST(Agreements, TheAdjustedRandIndexMatchesManualComputation) {
  EXPECT_DOUBLE_EQ(rand_index({1, 1, 2, 2}, {7, 7, 3, 3}), 1);
  EXPECT_NEAR(rand_index({1, 1, 2, 2}, {1, 1, 2, 3}), 4.0 / 7, 1e-12);
  EXPECT_NEAR(rand_index({1, 1, 1, 1}, {1, 2, 3, 4}), 0, 1e-12);
  EXPECT_NEAR(rand_index({1, 1, 2, 2}, {1, 2, 1, 2}), -0.5, 1e-12);
  // Shared pixels 5 1 0 / 1 4 1 / 2 0 3: 20 pairs in both, 40 and 44 in either, of 136.
  EXPECT_NEAR(rand_index({1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3},
                         {1, 1, 1, 1, 1, 2, 1, 2, 2, 2, 2, 3, 1, 1, 3, 3, 3}),
              (20 - 40.0 * 44 / 136) / (42 - 40.0 * 44 / 136), 1e-12);
  // Ignores pixels without a plane in either.
  EXPECT_NEAR(rand_index({1, 1, 2, 2, 0, 5}, {1, 1, 2, 3, 4, 0}), 4.0 / 7, 1e-12);
}

TEST(Agreements, EqualLabelsWithOtherNumbersAgreeFully) {
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

TEST(Agreements, FiguresOfAPartialAgreementMatchManualComputation) {
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
