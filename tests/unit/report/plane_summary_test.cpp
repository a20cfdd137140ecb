#include "core/report/plane_summary.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/hull.hpp"

namespace planescope {
namespace {

// A level square of 1 m and an upright one, sampled every centimetre.
struct TwoSquares {
  std::vector<Vec3f> points;
  std::vector<std::int32_t> plane_of;
  std::vector<PlaneRegion> planes;

  TwoSquares() {
    Moments floor, wall;
    for (int i = 0; i < 100; ++i) {
      for (int j = 0; j < 100; ++j) {
        const double a = 0.005 + 0.01 * i, b = 0.005 + 0.01 * j;
        add(Vec3d(a, b, 0), 1, floor);
        add(Vec3d(a, 2, b), 2, wall);
      }
    }
    points.emplace_back(0.5F, 1.5F, 0.7F);  // in no plane
    plane_of.push_back(0);
    planes = {{1, Label::h, fit_plane(floor), 1000}, {2, Label::v, fit_plane(wall), 900}};
  }
  void add(const Vec3d& p, int id, Moments& moments) {
    points.push_back(p.cast<float>());
    plane_of.push_back(id);
    moments.add(p);
  }
};

TEST(PlaneSummary, SizeTiltAndOffsetAreThoseOfTheSurface) {
  const TwoSquares scene;
  const Vec3d origin(100, 200, 5);
  const auto summaries = summarize_planes(scene.planes, scene.points, scene.plane_of, origin);
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_EQ(summaries[0].points, 10000u);
  EXPECT_EQ(summaries[0].voxels, 1000u);
  EXPECT_NEAR(summaries[0].area_m2, 1, 0.05);
  EXPECT_NEAR(summaries[0].tilt_deg, 0, 1e-3);
  EXPECT_NEAR(summaries[0].offset_m, 5, 1e-6);
  EXPECT_NEAR(summaries[1].tilt_deg, 90, 1e-3);
  EXPECT_NEAR(summaries[1].offset_m, 202, 1e-5);
}

TEST(PlaneSummary, HullLiesInThePlaneAndRunsCounterClockwiseAboutTheNormal) {
  const TwoSquares scene;
  const auto summaries =
      summarize_planes(scene.planes, scene.points, scene.plane_of, Vec3d::Zero());
  for (const PlaneSummary& plane : summaries) {
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
  TwoSquares scene;
  for (auto& id : scene.plane_of)
    if (id == 2) id = 0;
  const auto summaries =
      summarize_planes(scene.planes, scene.points, scene.plane_of, Vec3d::Zero());
  EXPECT_EQ(summaries[1].points, 0u);
  EXPECT_EQ(summaries[1].area_m2, 0);
  EXPECT_TRUE(summaries[1].hull.empty());
}

}  // namespace
}  // namespace planescope
