#include "core/report/data/plane_summary.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace planescope::report {
namespace {

// A level square of 1 m and an upright one, sampled every centimetre, and a point in no plane.
planes::FrameResult two_squares(const Vec3d& origin) {
  planes::FrameResult result;
  result.cloud.origin = origin;
  Moments moments[2];
  const auto add = [&](const Vec3d& p, int id) {
    result.cloud.points.push_back(p.cast<float>());
    result.plane_of.push_back(id);
    if (id > 0) moments[id - 1].add(p);
  };
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) {
      const double a = 0.005 + 0.01 * i, b = 0.005 + 0.01 * j;
      add(Vec3d(a, b, 0), 1);
      add(Vec3d(a, 2, b), 2);
    }
  }
  add(Vec3d(0.5, 1.5, 0.7), 0);
  result.segmentation.planes = {{1, Label::h, fit_plane(moments[0]), 1000},
                                {2, Label::v, fit_plane(moments[1]), 900}};
  return result;
}

TEST(PlaneSummary, SizeTiltAndOffsetAreThoseOfTheSurface) {
  const auto summaries = summarize_planes(two_squares(Vec3d(100, 200, 5)), 0.02);
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_EQ(summaries[0].points, 10000u);
  EXPECT_EQ(summaries[0].voxels, 1000u);
  EXPECT_NEAR(summaries[0].area_m2, 1, 0.05);
  EXPECT_NEAR(summaries[0].tilt_deg, 0, 1e-3);
  EXPECT_NEAR(summaries[0].offset_m, 5, 1e-6);
  EXPECT_NEAR(summaries[1].tilt_deg, 90, 1e-3);
  EXPECT_NEAR(summaries[1].offset_m, 202, 1e-5);
}

TEST(PlaneSummary, WithoutGravityNothingIsTilted) {
  planes::FrameResult result = two_squares(Vec3d::Zero());
  result.gravity.source = GravitySource::none;
  EXPECT_TRUE(std::isnan(summarize_planes(result, 0.02)[0].tilt_deg));
}

TEST(PlaneSummary, AreaDoesNotCountWhatWasNotMeasured) {
  planes::FrameResult result = two_squares(Vec3d::Zero());
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)  // an L: one quarter is missing
    if (result.cloud.points[i].x() > 0.5F && result.cloud.points[i].y() > 0.5F &&
        result.plane_of[i] == 1)
      result.plane_of[i] = 0;
  EXPECT_NEAR(summarize_planes(result, 0.02)[0].area_m2, 0.75, 0.05);
}

TEST(PlaneSummary, HullLiesInThePlaneAndRunsCounterClockwiseAboutTheNormal) {
  for (const PlaneSummary& plane : summarize_planes(two_squares(Vec3d::Zero()), 0.02)) {
    ASSERT_EQ(plane.hull.size(), 4u);
    Vec3d twice_area = Vec3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(plane.normal.dot(plane.hull[i]), plane.offset_m, 1e-9);
      twice_area += plane.hull[i].cross(plane.hull[(i + 1) % 4]);
    }
    EXPECT_NEAR(twice_area.dot(plane.normal) / 2, 0.99 * 0.99, 1e-3);
  }
}

TEST(PlaneSummary, APlaneThatLostAllItsPointsHasNoArea) {
  planes::FrameResult result = two_squares(Vec3d::Zero());
  for (auto& id : result.plane_of)
    if (id == 2) id = 0;
  const auto summaries = summarize_planes(result, 0.02);
  EXPECT_EQ(summaries[1].points, 0u);
  EXPECT_EQ(summaries[1].area_m2, 0);
  EXPECT_TRUE(summaries[1].hull.empty());
}

}  // namespace
}  // namespace planescope::report
