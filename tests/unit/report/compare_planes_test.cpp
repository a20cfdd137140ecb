#include "core/report/compare/compare_planes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace planescope::report {
namespace {

/// A strip of measurements, `plane_of` each tenth of it, and floors of the heights given.
struct Strip {
  RegionSample sample;
  std::vector<PlaneSummary> planes;
};

Strip strip(const std::vector<int>& plane_of_tenths, const std::vector<double>& heights_m) {
  Strip result;
  std::vector<int> plane_of;
  for (int i = 0; i < 100; ++i) plane_of.push_back(plane_of_tenths[i / 10]);
  result.sample = {1, 100, 1, runs_of(plane_of)};
  for (std::size_t k = 0; k < heights_m.size(); ++k) {
    PlaneSummary plane;
    plane.id = static_cast<int>(k) + 1;
    plane.label = Label::h;
    plane.centroid = {0.1 * plane.id, 0, heights_m[k]};
    plane.offset_m = heights_m[k];
    plane.area_m2 = 1;
    result.planes.push_back(plane);
  }
  return result;
}

std::vector<PlaneComparison> compare(const Strip& baseline, const Strip& now) {
  return compare_planes({baseline.planes, baseline.sample}, {now.planes, now.sample});
}

const Strip& three_floors() {
  static const Strip floors = strip({1, 1, 1, 1, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.4});
  return floors;
}

TEST(ComparePlanes, OfTheSameRunAllAreTheSame) {
  const auto found = compare(three_floors(), three_floors());
  ASSERT_EQ(found.size(), 3u);
  for (int k = 1; k <= 3; ++k) {
    const PlaneComparison& plane = found[static_cast<std::size_t>(k) - 1];
    EXPECT_EQ(plane.fate, PlaneFate::same);
    EXPECT_EQ(plane.baseline, k);
    EXPECT_EQ(plane.now, k);
    EXPECT_EQ(plane.iou, 1);
    EXPECT_EQ(plane.offset_m, 0);
  }
}

TEST(ComparePlanes, IdsDoNotMatterButPlacesDo) {
  const Strip renumbered = strip({3, 3, 3, 3, 0, 1, 1, 1, 2, 2}, {0.2, 0.4, 0});
  const auto found = compare(three_floors(), renumbered);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].now, 3);
  EXPECT_EQ(found[1].now, 1);
  EXPECT_EQ(found[2].now, 2);
}

TEST(ComparePlanes, ALostPlaneAndAGainedOneAreNamed) {
  const auto found = compare(three_floors(), strip({1, 1, 1, 1, 3, 2, 2, 2, 0, 0}, {0, 0.2, 0.9}));
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[2].fate, PlaneFate::lost);
  EXPECT_EQ(found[2].baseline, 3);
  EXPECT_EQ(found[3].fate, PlaneFate::gained);
  EXPECT_EQ(found[3].baseline, 0);
  EXPECT_EQ(found[3].now, 3);
}

TEST(ComparePlanes, FiveMillimetresOrOneDegreeAreAMove) {
  EXPECT_EQ(compare(three_floors(), strip({1, 1, 1, 1, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.404}))[2].fate,
            PlaneFate::same);
  const auto higher =
      compare(three_floors(), strip({1, 1, 1, 1, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.406}));
  EXPECT_EQ(higher[2].fate, PlaneFate::moved);
  EXPECT_NEAR(higher[2].offset_m, 0.006, 1e-12);

  Strip tilted = three_floors();
  const double angle = 1.5 * M_PI / 180;
  tilted.planes[1].normal = {std::sin(angle), 0, std::cos(angle)};
  tilted.planes[1].offset_m = tilted.planes[1].normal.dot(tilted.planes[1].centroid);
  const auto found = compare(three_floors(), tilted);
  EXPECT_EQ(found[1].fate, PlaneFate::moved);
  EXPECT_NEAR(found[1].angle_deg, 1.5, 1e-9);
}

TEST(ComparePlanes, AreaTellsWhatGrewOrShrank) {
  Strip shrunk = strip({1, 1, 1, 0, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.4});
  shrunk.planes[0].area_m2 = 0.75;
  const auto found = compare(three_floors(), shrunk);
  EXPECT_EQ(found[0].fate, PlaneFate::resized);
  EXPECT_EQ(found[0].area_ratio, 0.75);
  EXPECT_EQ(found[0].iou, 0.75);
}

TEST(ComparePlanes, ASplitNamesItsPartsAndAMergeThoseItIsMadeOf) {
  const Strip split = strip({1, 1, 4, 4, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.4, 0});
  const auto apart = compare(three_floors(), split);
  ASSERT_EQ(apart.size(), 3u) << "parts are not gained";
  EXPECT_EQ(apart[0].fate, PlaneFate::split);
  EXPECT_EQ(apart[0].now, 1);
  EXPECT_EQ(apart[0].others, std::vector<int>{4});

  const auto together = compare(split, three_floors());
  ASSERT_EQ(together.size(), 4u);
  EXPECT_EQ(together[0].fate, PlaneFate::merged);
  EXPECT_EQ(together[3].fate, PlaneFate::merged);
  EXPECT_EQ(together[0].now, 1);
  EXPECT_EQ(together[0].others, std::vector<int>{4});
  EXPECT_EQ(together[1].fate, PlaneFate::same);
}

TEST(ComparePlanes, OfPlanesWithoutSamplesPlaceAndDirectionDecide) {
  const Strip before = strip({1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, {0, 0.2});
  Strip after = before;
  after.planes[1].centroid.z() = after.planes[1].offset_m = 0.203;
  EXPECT_EQ(compare(before, after)[1].fate, PlaneFate::same);
  after.planes[1].label = Label::v;
  const auto found = compare(before, after);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[1].fate, PlaneFate::lost);
  EXPECT_EQ(found[2].fate, PlaneFate::gained);
}

TEST(ComparePlanes, AReportWithoutSamplesIsComparedByPlaceAndDirection) {
  Strip before = three_floors();
  before.sample = {};
  Strip after = three_floors();
  after.planes[2].centroid.z() = after.planes[2].offset_m = 0.42;
  const auto found = compare(before, after);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].fate, PlaneFate::same);
  EXPECT_EQ(found[2].fate, PlaneFate::moved);
}

TEST(ComparePlanes, NothingIsComparedWithNothing) {
  const Strip none = strip(std::vector<int>(10, 0), {});
  EXPECT_TRUE(compare(none, none).empty());
  EXPECT_EQ(compare(none, three_floors()).size(), 3u);
  EXPECT_EQ(compare(three_floors(), none)[0].fate, PlaneFate::lost);
}

TEST(ComparePlanes, SamplesOfOtherPixelsDecideNothing) {
  Strip other = three_floors();
  other.sample = {1, 7, 1, {{1, 7}}};
  for (const PlaneComparison& plane : compare(three_floors(), other)) {
    EXPECT_EQ(plane.fate, PlaneFate::same);
    EXPECT_EQ(plane.iou, 0);
  }
}

}  // namespace
}  // namespace planescope::report
