// Tests of Open3D's RANSAC as a plane-finding method.

#include <gtest/gtest.h>
#include <omp.h>

#include <thread>

#include "core/io/open3d/install.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "support/found_planes.hpp"

namespace planescope::open3d {
namespace {

TEST(Ransac, FindsAFloorAndTheSmallerWallOnIt) {
  const std::vector<Vec3f> points = test::floor_and_wall(3000, 1500, 0.002);
  const planes::FoundPlanes found = find_planes_ransac(points, {});
  ASSERT_EQ(found.planes.size(), 2u);
  EXPECT_LT(test::angle_deg(found.planes[0].normal, Vec3d::UnitZ()), 0.5);
  EXPECT_LT(test::angle_deg(found.planes[1].normal, Vec3d::UnitX()), 0.5);
  ASSERT_EQ(found.plane_of.size(), points.size());
  EXPECT_GT(std::ranges::count(found.plane_of, 1), 2900);
  EXPECT_GT(std::ranges::count(found.plane_of, 2), 1400);
}

TEST(Ransac, FindsNoPlaneOfTooFewPoints) {
  const std::vector<Vec3f> points = test::floor_and_wall(500, 40);
  EXPECT_EQ(find_planes_ransac(points, {}).planes.size(), 1u);
  EXPECT_EQ(find_planes_ransac(points, {.min_points = 30}).planes.size(), 2u);
  EXPECT_TRUE(find_planes_ransac(points, {.min_points = 541}).planes.empty());
}

TEST(Ransac, FindsNothingWhereNothingIsPlanar) {
  const planes::FoundPlanes found = find_planes_ransac(test::points_everywhere(400), {});
  EXPECT_TRUE(found.planes.empty());
  EXPECT_EQ(found.plane_of, std::vector<std::int32_t>(400, 0));
}

TEST(Ransac, FindsNoPlaneOfPointsOnOneLine) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 100; ++i) points.emplace_back(static_cast<float>(i), 0.0f, 0.0f);
  EXPECT_TRUE(find_planes_ransac(points, {}).planes.empty());
}

TEST(Ransac, FindsNothingInAnEmptyCloud) {
  const planes::FoundPlanes found = find_planes_ransac({}, {.min_points = 0});
  EXPECT_TRUE(found.planes.empty());
  EXPECT_TRUE(found.plane_of.empty());
}

TEST(Ransac, IsDeterministicAlsoInParallel) {
  const std::vector<Vec3f> points = test::floor_and_wall(2000, 1000, 0.004);
  const planes::FoundPlanes once = find_planes_ransac(points, {});
  EXPECT_TRUE(test::same(once, find_planes_ransac(points, {})));
  planes::FoundPlanes others[2];
  {
    std::jthread a([&] { others[0] = find_planes_ransac(points, {}); });
    std::jthread b([&] { others[1] = find_planes_ransac(points, {}); });
  }
  EXPECT_TRUE(test::same(once, others[0]));
  EXPECT_TRUE(test::same(once, others[1]));
  EXPECT_FALSE(test::same(once, find_planes_ransac(points, {.seed = 2})));
}

TEST(Ransac, DoesNotChangeTheCallersThreads) {
  omp_set_num_threads(3);
  find_planes_ransac(test::floor_and_wall(200, 0), {});
  EXPECT_EQ(omp_get_max_threads(), 3);
}

TEST(Ransac, IsAMethodOfProgramsThatHaveOpen3d) {
  planes::PipelineOptions options;
  options.gravity.mode = planes::GravityMode::none;
  planes::set_option(options, "method", "ransac");
  planes::set_option(options, "ransac_theta_pf_m", "0.02");
  EXPECT_EQ(options.rivals.ransac.theta_pf_m, 0.02);
  EXPECT_TRUE(planes::find_option("ransac_theta_pf_m").matters(options));
  options.cloud.voxel_size_m = 0;
  Frame frame;
  frame.cloud.emplace().points = test::floor_and_wall(3000, 1500, 0.002);
  const planes::FrameResult result = planes::run_frame(frame, options, nullptr);
  const planes::FoundPlanes found =
      open3d::find_planes_ransac(result.voxels.points, options.rivals.ransac);
  EXPECT_EQ(result.segmentation.planes.size(), 2u);
  EXPECT_EQ(result.segmentation.plane_of, found.plane_of);
}

}  // namespace
}  // namespace planescope::open3d
