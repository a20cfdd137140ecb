// Tests of making a frame's cloud: rotation to gravity, cropping and the bounding cube.

#include "core/planes/cloud/cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/model/error.hpp"
#include "core/planes/cloud/camera.hpp"

namespace planescope::planes {
namespace {

Gravity down(const Vec3d& direction) {
  Gravity gravity;
  gravity.direction = direction.normalized();
  return gravity;
}

Frame depth_frame(int width, int height, std::uint16_t counts) {
  Frame frame;
  frame.name = "test";
  frame.depth = Image16(width, height, 1, counts);
  frame.depth_unit_m = 0.001;
  frame.intrinsics.width = width;
  frame.intrinsics.height = height;
  frame.intrinsics.fx = frame.intrinsics.fy = 0.6 * width;
  frame.intrinsics.cx = width / 2.0;
  frame.intrinsics.cy = height / 2.0;
  return frame;
}

Frame cloud_frame(std::vector<Vec3f> points) {
  Frame frame;
  frame.name = "cloud";
  frame.cloud.emplace();
  frame.cloud->points = std::move(points);
  return frame;
}

TEST(Cloud, GravityIsMinusZAndForwardKeepsItsHalfPlane) {
  const Vec3d g = Vec3d(-0.323, 0.844, 0.428).normalized();
  const Pose pose = world_from_gravity(g, true);
  EXPECT_LT((pose.linear() * g - Vec3d(0, 0, -1)).norm(), 1e-15);
  const Vec3d forward = pose.linear() * Vec3d::UnitZ();
  EXPECT_NEAR(forward.y(), 0, 1e-15);
  EXPECT_GT(forward.x(), 0);
  EXPECT_NEAR(pose.linear().determinant(), 1, 1e-15);
}

TEST(Cloud, LookingStraightDownStillGivesARotation) {
  for (const Vec3d& g : {Vec3d(0, 0, 1), Vec3d(0, 0, -1)}) {
    const Mat3d R = world_from_gravity(g, true).linear();
    EXPECT_LT((R * R.transpose() - Mat3d::Identity()).norm(), 1e-14);
    EXPECT_NEAR(R.determinant(), 1, 1e-14);
    EXPECT_LT((R * g - Vec3d(0, 0, -1)).norm(), 1e-14);
  }
}

TEST(Cloud, AnUprightCloudIsNotRotated) {
  EXPECT_EQ(world_from_gravity(Vec3d(0, 0, -1), false).linear(), Mat3d::Identity());
}

TEST(Cloud, PointsAreOnTheRaysOfTheirPixels) {
  Frame frame = depth_frame(64, 48, 1000);
  frame.depth.at(5, 7) = 1400;
  const Gravity gravity = down({0.1, 0.8, 0.5});
  const Cloud cloud = make_cloud(frame, gravity, {});
  ASSERT_EQ(cloud.points.size(), 64u * 48u);
  const std::size_t i = 7 * 64 + 5;
  EXPECT_EQ(cloud.source[i], i);
  const Vec2d ray = pixel_to_ray(frame.intrinsics, 5, 7);
  const Vec3d sensor(ray.x() * 1.4, ray.y() * 1.4, 1.4);
  EXPECT_LT((cloud.points[i].cast<double>() - cloud.T_world_sensor * sensor).norm(), 1e-6);
}

TEST(Cloud, DistortionIsRemoved) {
  Frame frame = depth_frame(64, 48, 1000);
  frame.intrinsics.distortion = Distortion::brown_conrady;
  frame.intrinsics.coefficients = {0.1, -0.05, 0.001, 0.002, 0};
  const Cloud cloud = make_cloud(frame, down({0, 1, 0}), {});
  const Vec3d sensor = cloud.T_world_sensor.inverse() * cloud.points[0].cast<double>();
  const Vec2d pixel = ray_to_pixel(frame.intrinsics, sensor.head<2>() / sensor.z());
  EXPECT_NEAR(pixel.x(), 0, 1e-3);
  EXPECT_NEAR(pixel.y(), 0, 1e-3);
}

TEST(Cloud, EveryPixelIsAccountedFor) {
  Frame frame = depth_frame(64, 48, 1000);
  frame.depth.at(0, 0) = 0;
  frame.depth.at(1, 0) = 0;
  frame.depth.at(2, 0) = 65535;
  frame.depth.at(3, 0) = 1500;  // at the limit; kept
  frame.depth.at(4, 0) = 1501;
  const Cloud cloud = make_cloud(frame, down({0, 1, 0}), {});
  EXPECT_EQ(cloud.counts.pixels, 64u * 48u);
  EXPECT_EQ(cloud.counts.no_measurement, 2u);
  EXPECT_EQ(cloud.counts.invalid, 1u);
  EXPECT_EQ(cloud.counts.beyond_range, 1u);
  EXPECT_EQ(cloud.counts.outside_cube, 0u);
  EXPECT_EQ(cloud.counts.kept, 64u * 48u - 4);
  EXPECT_EQ(cloud.points.size(), 64u * 48u - 3) << "cropped points stay, marked";
  EXPECT_EQ(cloud.kept[0], 1);
  EXPECT_EQ(cloud.source[0], 3u);
  EXPECT_EQ(cloud.kept[1], 0);
}

TEST(Cloud, CornersOutsideTheCubeAreCountedNotClamped) {
  // At 1.45 m, a lens with a focal length of 0.3 widths sees 2.4 m to either side, but the cube
  // covers 1.6 m.
  Frame frame = depth_frame(64, 48, 1450);
  frame.intrinsics.fx = frame.intrinsics.fy = 0.3 * 64;
  const Cloud cloud = make_cloud(frame, down({0, 1, 0}), {});
  EXPECT_DOUBLE_EQ(cloud.cube.edge_m, 3.2);
  EXPECT_EQ(cloud.cube.max_depth, 8);
  EXPECT_GT(cloud.counts.outside_cube, 0u);
  EXPECT_EQ(cloud.counts.kept + cloud.counts.outside_cube, cloud.counts.pixels);
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    EXPECT_EQ(cloud.kept[i] == 1, cloud.points[i].cwiseAbs().maxCoeff() < 1.6f);
}

TEST(Cloud, TheCubeGrowsByPowersOfTwoAndItsLeafSizeStays) {
  const Frame frame = depth_frame(8, 6, 1000);
  for (const auto& [range_m, edge_m, depth] :
       {std::tuple{1.0, 3.2, 8}, {1.6, 3.2, 8}, {1.7, 6.4, 9}, {4.0, 12.8, 10}}) {
    CloudOptions options;
    options.max_range_m = range_m;
    const Cube cube = make_cloud(frame, down({0, 1, 0}), options).cube;
    EXPECT_DOUBLE_EQ(cube.edge_m, edge_m) << range_m;
    EXPECT_EQ(cube.max_depth, depth) << range_m;
    EXPECT_DOUBLE_EQ(cube.edge_m / (1 << cube.max_depth), 0.0125);
    EXPECT_TRUE(cube.min_corner.isApprox(Vec3d::Constant(-edge_m / 2)));
  }
}

TEST(Cloud, AnUnlimitedRangeEndsAtTheLargestCount) {
  CloudOptions options;
  options.max_range_m = std::numeric_limits<double>::infinity();
  const Cloud cloud = make_cloud(depth_frame(8, 6, 60000), down({0, 1, 0}), options);
  EXPECT_EQ(cloud.counts.kept, 48u);
  EXPECT_DOUBLE_EQ(cloud.cube.edge_m, 204.8);
}

TEST(Cloud, TheCubeContainsTheWholeCloud) {
  std::vector<Vec3f> points;
  for (float i = 0; i < 1000; ++i)
    points.emplace_back(std::sin(i) * 3.7f, std::cos(i * 1.3f) * 0.4f, std::sin(i * 0.7f) + 20);
  Frame frame = cloud_frame(points);
  frame.cloud->origin = Vec3d(432100.25, 5543210.5, 110);
  const Cloud cloud = make_cloud(frame, down({0, 0, -1}), {});
  EXPECT_EQ(cloud.counts.kept, points.size());
  EXPECT_DOUBLE_EQ(cloud.cube.edge_m, 12.8);
  EXPECT_EQ(cloud.cube.max_depth, 10);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d world = cloud.origin + cloud.points[i].cast<double>();
    EXPECT_LT((world - (frame.cloud->origin + points[i].cast<double>())).norm(), 1e-5);
  }
}

TEST(Cloud, ASmallUprightCloudKeepsItsCoordinates) {
  const std::vector<Vec3f> points{{0.1f, 0.2f, 0.3f}, {-0.123456f, 0.4f, 0.25f}};
  const Cloud cloud = make_cloud(cloud_frame(points), down({0, 0, -1}), {});
  EXPECT_EQ(cloud.origin, Vec3d::Zero());
  EXPECT_EQ(cloud.points, points);
}

TEST(Cloud, PixelsWithPointsBeyondFloatsAreInvalid) {
  Frame frame = depth_frame(8, 6, 1000);
  frame.intrinsics.fx = 1e-300;
  frame.intrinsics.cx = 3;  // the column that looks straight ahead has points
  const Cloud cloud = make_cloud(frame, down({0, 1, 0}), {});
  EXPECT_EQ(cloud.counts.invalid, 8u * 6u - 6);
  EXPECT_EQ(cloud.points.size(), 6u);
  for (const Vec3f& point : cloud.points) EXPECT_TRUE(point.allFinite());
}

TEST(Cloud, NanInfinityAndTheOriginAreNotPoints) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const Cloud cloud =
      make_cloud(cloud_frame({{1, 1, 1}, {nan, 0, 0}, {0, inf, 0}, {0, 0, 0}, {2, 2, 2}}),
                 down({0, 0, -1}), {});
  EXPECT_EQ(cloud.counts.invalid, 2u);
  EXPECT_EQ(cloud.counts.no_measurement, 1u);
  EXPECT_EQ(cloud.counts.kept, 2u);
  EXPECT_EQ(cloud.source, (std::vector<std::uint32_t>{0, 4}));
}

TEST(Cloud, AStrayCostsNoneOfTheOthers) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 2000; ++i)
    points.emplace_back(0.02f * static_cast<float>(i % 50), 0.02f * static_cast<float>(i / 50), 1);
  const Cloud alone = make_cloud(cloud_frame(points), down({0, 0, -1}), {});
  const std::size_t voxels = voxelize(alone, 0.02).points.size();
  for (const float far_m : {300.f, 9e3f, 1e5f, 1e7f, 1e30f}) {
    auto with_stray = points;
    with_stray.emplace_back(far_m, -far_m, 0.5f);
    const Cloud cloud = make_cloud(cloud_frame(with_stray), down({0, 0, -1}), {});
    EXPECT_EQ(cloud.counts.kept + cloud.counts.outside_cube, 2001u) << far_m;
    EXPECT_EQ(cloud.counts.outside_cube, far_m > 1e4f ? 1u : 0u) << far_m;
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_TRUE(cloud.kept[i]) << far_m;
      ASSERT_LT((cloud.origin + cloud.points[i].cast<double>() - points[i].cast<double>()).norm(),
                1e-6)
          << far_m;
    }
    const std::size_t found = voxelize(cloud, 0.02).points.size();
    EXPECT_NEAR(static_cast<double>(found), static_cast<double>(voxels),
                0.05 * static_cast<double>(voxels))
        << far_m;
  }
}

TEST(Cloud, PointsThatAreMostlyTooFarApartAreRejected) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 100; ++i) points.emplace_back(1e6f * static_cast<float>(i), 0, 1);
  EXPECT_THROW(make_cloud(cloud_frame(points), down({0, 0, -1}), {}), Error);
}

TEST(Cloud, CloudsAreCroppedByRangeOnlyOnRequest) {
  const Frame frame = cloud_frame({{1, 0, 0}, {3, 0, 0}, {0, 100, 0}});
  EXPECT_EQ(make_cloud(frame, down({0, 0, -1}), {}).counts.kept, 3u);
  CloudOptions options;
  options.range_for_clouds = true;
  const Cloud cloud = make_cloud(frame, down({0, 0, -1}), options);
  EXPECT_EQ(cloud.counts.kept, 1u);
  EXPECT_EQ(cloud.counts.beyond_range, 2u);
  EXPECT_DOUBLE_EQ(cloud.cube.edge_m, 3.2);
}

TEST(Cloud, AFrameWithoutOneMeasurementIsEmptyNotAnError) {
  EXPECT_EQ(make_cloud(depth_frame(8, 6, 0), down({0, 1, 0}), {}).counts.kept, 0u);
  const Cloud cloud = make_cloud(cloud_frame({}), down({0, 0, -1}), {});
  EXPECT_EQ(cloud.counts.kept, 0u);
  EXPECT_DOUBLE_EQ(cloud.cube.edge_m, 3.2);
}

TEST(Cloud, InvalidInputIsRejected) {
  Frame frame = depth_frame(8, 6, 1000);
  CloudOptions options;
  options.max_range_m = 0;
  EXPECT_THROW(make_cloud(frame, down({0, 1, 0}), options), Error);
  frame.intrinsics.width = 9;
  EXPECT_THROW(make_cloud(frame, down({0, 1, 0}), {}), Error);
}

}  // namespace
}  // namespace planescope::planes
