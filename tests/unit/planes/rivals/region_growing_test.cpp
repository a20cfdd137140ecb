// Tests of region growing on depth images and on point clouds.

#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "core/lab/synthetic/stairs.hpp"
#include "core/planes/rivals/rivals.hpp"
#include "support/found_planes.hpp"

namespace planescope::planes {
namespace {

constexpr int kWidth = 320, kHeight = 240;

/// Measurements of a camera at the origin that looks along z.
struct View {
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> pixel;
  std::vector<std::uint8_t> kept;

  PixelPoints pixels() const {
    return {.points = points, .pixel = pixel, .kept = kept, .width = kWidth, .height = kHeight};
  }
};

/// `depth_m` of a ray (x, y, 1); 0: no measurement.
View view_of(const std::function<double(double, double)>& depth_m) {
  View view;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double x = (u - kWidth / 2) / 200.0, y = (v - kHeight / 2) / 200.0;
      const double z = depth_m(x, y);
      if (z <= 0) continue;
      view.points.push_back((z * Vec3d(x, y, 1)).cast<float>());
      view.pixel.push_back(static_cast<std::uint32_t>(v * kWidth + u));
      view.kept.push_back(1);
    }
  }
  return view;
}

/// A wall 1.2 m ahead on a floor 0.4 m below the camera.
double wall_on_floor(double, double y) { return y > 0 ? std::min(1.2, 0.4 / y) : 1.2; }

TEST(RegionGrowingOfImages, FindsAWallAndTheFloorBelowIt) {
  const View view = view_of(wall_on_floor);
  const FoundPlanes found = grow_regions(view.pixels(), {});
  ASSERT_EQ(found.planes.size(), 2u);
  EXPECT_LT(test::angle_deg(found.planes[0].normal, Vec3d::UnitZ()), 0.1);
  EXPECT_LT(test::angle_deg(found.planes[1].normal, Vec3d::UnitY()), 0.1);
  EXPECT_EQ(std::ranges::count(found.plane_of, 0), 0);
}

TEST(RegionGrowingOfImages, AssignsBorderPixelsToTheNearerPlane) {
  const View view = view_of(wall_on_floor);
  const auto wrong = [&](bool refine) {
    const FoundPlanes found = grow_regions(view.pixels(), {.refine_boundaries = refine});
    int count = 0;
    for (std::size_t i = 0; i < view.points.size(); ++i) {
      const bool on_wall = view.points[i].z() > 1.2f - 1e-4f;
      count += found.plane_of[i] != (on_wall ? 1 : 2);
    }
    return count;
  };
  EXPECT_LE(wrong(true), kWidth);  // the row that belongs to both
  EXPECT_GT(wrong(false), 5 * kWidth);
}

TEST(RegionGrowingOfImages, IgnoresHolesAndCroppedPixels) {
  View view = view_of(
      [](double x, double y) { return std::hypot(x - 0.2, y) < 0.1 ? 0 : wall_on_floor(x, y); });
  for (std::size_t i = 0; i < view.points.size(); ++i) view.kept[i] = view.points[i].x() > -0.3f;
  const FoundPlanes found = grow_regions(view.pixels(), {});
  ASSERT_EQ(found.planes.size(), 2u);
  ASSERT_EQ(found.plane_of.size(), view.points.size());
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    ASSERT_EQ(found.plane_of[i] > 0, view.kept[i] != 0) << i;
  }
}

TEST(RegionGrowingOfImages, SeparatesAPlaneFromAParallelOneBehindIt) {
  const View view = view_of([](double x, double) { return x < 0.05 ? 1.0 : 1.05; });
  EXPECT_EQ(grow_regions(view.pixels(), {}).planes.size(), 2u);
}

TEST(RegionGrowingOfImages, TakesCellsThickerThanTheThresholdForNoPlane) {
  Random random(5);
  const View view = view_of([&](double, double) { return 1 + 0.003 * random.normal(); });
  EXPECT_EQ(grow_regions(view.pixels(), {}).planes.size(), 1u);
  EXPECT_TRUE(grow_regions(view.pixels(), {.region_threshold_m2 = 0.001}).planes.empty());
}

TEST(RegionGrowingOfImages, AllowsMoreNoiseOnDistantSurfaces) {
  const auto noisy_wall_at = [](double distance_m) {
    Random random(5);
    return view_of([&](double, double) { return distance_m + 0.007 * random.normal(); });
  };
  EXPECT_TRUE(grow_regions(noisy_wall_at(1.0).pixels(), {}).planes.empty());
  EXPECT_EQ(grow_regions(noisy_wall_at(1.4).pixels(), {}).planes.size(), 1u);
}

TEST(RegionGrowingOfImages, FindsNothingWhereNothingIsPlanar) {
  Random random(5);
  const View view = view_of([&](double, double) { return random.uniform(0.5, 1.5); });
  EXPECT_TRUE(grow_regions(view.pixels(), {}).planes.empty());
}

TEST(RegionGrowingOfImages, FindsNothingInAnEmptyOrCroppedImage) {
  const FoundPlanes none = grow_regions(View().pixels(), {});
  EXPECT_TRUE(none.planes.empty());
  EXPECT_TRUE(none.plane_of.empty());
  View cropped = view_of(wall_on_floor);
  cropped.kept.assign(cropped.points.size(), 0);
  const FoundPlanes found = grow_regions(cropped.pixels(), {});
  EXPECT_TRUE(found.planes.empty());
  EXPECT_EQ(found.plane_of, std::vector<std::int32_t>(cropped.points.size(), 0));
}

TEST(RegionGrowingOfImages, FindsTheSamePlanesInAnyCoordinateFrame) {
  View view = view_of(wall_on_floor);
  const FoundPlanes before = grow_regions(view.pixels(), {});
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(2, Vec3f(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3f away(1, -2, 0.5f);
  for (Vec3f& p : view.points) p = turn * p + away;
  PixelPoints turned = view.pixels();
  turned.sensor = away;
  turned.view = turn * Vec3f::UnitZ();
  const FoundPlanes after = grow_regions(turned, {});
  ASSERT_EQ(after.planes.size(), before.planes.size());
  int moved = 0;
  for (std::size_t i = 0; i < view.points.size(); ++i)
    moved += before.plane_of[i] != after.plane_of[i];
  EXPECT_LE(moved, kWidth);  // the row that is equally near to both planes
}

TEST(RegionGrowingOfImages, AnswersTheSameAgainAndInThreadsAtATime) {
  const View view = view_of(wall_on_floor);
  const FoundPlanes once = grow_regions(view.pixels(), {});
  FoundPlanes others[2];
  {
    std::jthread a([&] { others[0] = grow_regions(view.pixels(), {}); });
    std::jthread b([&] { others[1] = grow_regions(view.pixels(), {}); });
  }
  EXPECT_TRUE(test::same(once, others[0]));
  EXPECT_TRUE(test::same(once, others[1]));
}

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

TEST(RegionGrowingOfPoints, AssignsEdgePointsToTheNearerPlane) {
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

TEST(RegionGrowingOfPoints, MergesOnlyRegionsWithSimilarNormals) {
  std::vector<Vec3f> points;  // a ramp of 20 degrees on a floor: too steep to grow across
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 30; ++j) {
      const double x = 0.01 * (i - 30), y = 0.01 * j;
      points.push_back(Vec3d(x, y, x > 0 ? 0.364 * x : 0).cast<float>());
    }
  }
  EXPECT_EQ(grow(points).planes.size(), 2u);
  // If the only condition is that the union is thin, they are merged.
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
