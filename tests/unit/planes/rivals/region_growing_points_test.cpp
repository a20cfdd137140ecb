#include <gtest/gtest.h>

#include <thread>

#include "core/lab/synthetic/stairs.hpp"
#include "core/planes/rivals/region_growing.hpp"
#include "unit/planes/rivals/found_planes_support.hpp"

namespace planescope::planes {
namespace {

FoundPlanes grow(const std::vector<Vec3f>& points, const RegionGrowingOptions& options = {}) {
  return grow_regions(points, options);
}

TEST(RegionGrowingOfPoints, FindsAFloorAndTheSmallerWallOnIt) {
  const std::vector<Vec3f> points = test::floor_and_wall(3000, 1500, 0.001);
  const FoundPlanes found = grow(points);
  ASSERT_EQ(found.planes.size(), 2u);
  EXPECT_LT(test::angle_deg(found.planes[0].normal, Vec3d::UnitZ()), 0.3);
  EXPECT_LT(test::angle_deg(found.planes[1].normal, Vec3d::UnitX()), 0.3);
  ASSERT_EQ(found.plane_of.size(), points.size());
  EXPECT_GT(std::ranges::count(found.plane_of, 1), 2900);
  EXPECT_GT(std::ranges::count(found.plane_of, 2), 1400);
}

TEST(RegionGrowingOfPoints, FindsEveryTreadAndRiserOfAStaircase) {
  const lab::Stairs stairs = lab::make_stairs(0, {.seed = 1001, .noise_m = 0.001});
  EXPECT_EQ(grow(stairs.cloud.points).planes.size(), stairs.normals.size());
}

TEST(RegionGrowingOfPoints, GivesPointsAlongAnEdgeToTheNearerPlane) {
  const std::vector<Vec3f> points = test::floor_and_wall(3000, 1500);
  const auto in_none = [&](const FoundPlanes& found) {
    return std::ranges::count(found.plane_of, 0);
  };
  EXPECT_EQ(in_none(grow(points)), 0);
  EXPECT_GT(in_none(grow(points, {.voxel_size_m = 0.07, .refine_boundaries = false})), 0);
}

TEST(RegionGrowingOfPoints, TakesCellsThickerThanTheThresholdForNoPlane) {
  const std::vector<Vec3f> points = test::floor_and_wall(6000, 0, 0.003);
  EXPECT_EQ(grow(points).planes.size(), 1u);
  EXPECT_TRUE(grow(points, {.region_threshold_m2 = 0.0001}).planes.empty());
}

TEST(RegionGrowingOfPoints, MergesRegionsOnlyWhoseNormalsAreNearEnough) {
  std::vector<Vec3f> points;  // a ramp of 20 degrees on a floor: the angle is too wide to grow over
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 30; ++j) {
      const double x = 0.01 * (i - 30), y = 0.01 * j;
      points.push_back(Vec3d(x, y, x > 0 ? 0.364 * x : 0).cast<float>());
    }
  }
  EXPECT_EQ(grow(points).planes.size(), 2u);
  // Where all that is asked for is that the union be thin, they are one.
  EXPECT_EQ(grow(points, {.region_threshold_m2 = 1}).planes.size(), 1u);
  EXPECT_EQ(grow(points, {.region_threshold_m2 = 1, .merge_threshold = 0.95}).planes.size(), 2u);
}

TEST(RegionGrowingOfPoints, FindsNothingWhereNothingIsPlanar) {
  const FoundPlanes found = grow(test::points_everywhere(100000));
  EXPECT_TRUE(found.planes.empty());
  EXPECT_EQ(found.plane_of, std::vector<std::int32_t>(100000, 0));
}

TEST(RegionGrowingOfPoints, FindsNothingInAnEmptyCloud) {
  EXPECT_TRUE(grow({}).planes.empty());
  EXPECT_TRUE(grow({}).plane_of.empty());
}

TEST(RegionGrowingOfPoints, AnswersTheSameAgainAndInThreadsAtATime) {
  const std::vector<Vec3f> points =
      lab::make_stairs(3, {.seed = 1001, .noise_m = 0.002}).cloud.points;
  const FoundPlanes once = grow(points);
  FoundPlanes others[2];
  {
    std::jthread a([&] { others[0] = grow(points); });
    std::jthread b([&] { others[1] = grow(points); });
  }
  EXPECT_TRUE(test::same(once, others[0]));
  EXPECT_TRUE(test::same(once, others[1]));
}

}  // namespace
}  // namespace planescope::planes
