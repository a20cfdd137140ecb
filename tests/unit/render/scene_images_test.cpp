#include <gtest/gtest.h>

#include <cmath>

#include "render/frame_image.hpp"
#include "render/paint.hpp"
#include "render/palette.hpp"
#include "render/scenes.hpp"

namespace planescope::render {
namespace {

// A wall 1 m away that fills the image, as plane 1, but for a column of plane 2 at the right.
struct WallFrame {
  Frame frame;
  planes::FrameResult result;

  WallFrame() {
    frame.depth = Image16(40, 30, 1, 1000);
    frame.depth_unit_m = 0.001;
    frame.intrinsics = {40, 30, 40, 40, 20, 15};
    result.segmentation.planes.resize(2);
    for (int v = 0; v < 30; ++v) {
      for (int u = 0; u < 40; ++u) {
        result.cloud.points.emplace_back((static_cast<float>(u) - 20) / 40,
                                         (static_cast<float>(v) - 15) / 40, 1.0F);
        result.cloud.source.push_back(static_cast<std::uint32_t>(v * 40 + u));
        result.cloud.kept.push_back(1);
        result.plane_of.push_back(u < 30 ? 1 : 2);
      }
    }
  }
};

TEST(RegionImage, DepthPixelsLeaveNoHolesInALargerColourImage) {
  WallFrame wall;
  wall.frame.color = Image8(160, 120, 3, 128);
  wall.frame.color_intrinsics = {160, 120, 130, 130, 80, 60};
  wall.frame.T_color_depth.translation() = Vec3d(0.05, 0, 0);
  const RegionImage regions = regions_on_color(wall.frame, wall.result);
  ASSERT_EQ(regions.width, 160);
  // The wall spans -0.5 .. 0.475 m and -0.375 .. 0.35 m: in the colour image from u 21.5, v 11.25.
  int holes = 0;
  for (int v = 14; v < 102; ++v)
    for (int u = 25; u < 145; ++u) holes += regions.at(u, v) == 0;
  EXPECT_EQ(holes, 0);
  EXPECT_EQ(regions.at(5, 60), 0);
  EXPECT_EQ(regions.at(60, 60), 1);
  EXPECT_EQ(regions.at(140, 60), 2);  // plane 2 begins at (0.25 - 0.0125 + 0.05) * 130 + 80 = 117
}

TEST(RegionImage, TheNearestSurfaceIsInFront) {
  WallFrame wall;
  wall.frame.color = Image8(40, 30, 3);
  wall.frame.color_intrinsics = wall.frame.intrinsics;
  wall.result.cloud.points.emplace_back(0.0F, 0.0F, 0.5F);
  wall.result.cloud.source.push_back(0);
  wall.result.plane_of.push_back(2);
  EXPECT_EQ(regions_on_color(wall.frame, wall.result).at(20, 15), 2);
}

TEST(RegionImage, SmoothingClosesPinholesAndKeepsEdges) {
  RegionImage regions(20, 20, 1, 1);
  for (int y = 0; y < 20; ++y)
    for (int x = 10; x < 20; ++x) regions.at(x, y) = 2;
  regions.at(5, 5) = 0;
  regions.at(15, 5) = 1;
  const RegionImage smooth = smooth_regions(regions);
  EXPECT_EQ(smooth.at(5, 5), 1);
  EXPECT_EQ(smooth.at(15, 5), 2);
  EXPECT_EQ(smooth.at(9, 10), 1);
  EXPECT_EQ(smooth.at(10, 10), 2);
}

TEST(RegionImage, InteriorPointsAreDeepInsideTheirRegions) {
  RegionImage regions(60, 40, 1, 0);
  for (int y = 5; y < 35; ++y)  // an L: its centre of mass is near its inner corner
    for (int x = 5; x < 55; ++x)
      if (x < 25 || y >= 25) regions.at(x, y) = 1;
  const auto points = interior_points(regions, 2);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(regions.at(points[0].x, points[0].y), 1);
  EXPECT_NEAR(points[0].x, 15, 3);
  EXPECT_GE(points[0].depth_px, 9);
  EXPECT_EQ(points[1].depth_px, 0);  // plane 2 is not in the image
}

TEST(ImageOverlay, TintsTheAlignedColourImageAndLeavesTheRest) {
  WallFrame wall;
  wall.frame.color = Image8(40, 30, 3, 100);
  wall.frame.color_aligned = true;
  for (auto& id : wall.result.plane_of)
    if (id == 2) id = 0;
  const Image8 image = image_overlay(wall.frame, wall.result, {});
  const int factor = enlargement(40);
  ASSERT_EQ(image.width, 40 * factor);
  ASSERT_EQ(image.height, 30 * factor);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(image.at(35 * factor, 5 * factor, c), 100);
  const Rgba tint = plane_color(1);
  EXPECT_LT(image.at(5 * factor, 5 * factor, 0), 100);  // plane 1 is blue
  EXPECT_NEAR(image.at(5 * factor, 5 * factor, 2), 100 + 0.4 * (tint.b - 100), 2);
}

TEST(ImageOverlay, WithoutCalibratedColourTheDepthIsShaded) {
  WallFrame wall;
  wall.frame.color = Image8(80, 60, 3, 255);  // neither aligned nor calibrated
  const Image8 image = image_overlay(wall.frame, wall.result, {});
  EXPECT_EQ(image.width, 40 * enlargement(40));
}

TEST(ImageDepth, NearAndFarDifferAndTheUnmeasuredIsGrey) {
  WallFrame wall;
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 10; ++u) wall.frame.depth.at(u, v) = 500;
    for (int u = 30; u < 35; ++u) wall.frame.depth.at(u, v) = 0;
    for (int u = 35; u < 40; ++u) wall.frame.depth.at(u, v) = 4000;
  }
  const Image8 image = image_depth(wall.frame, 1.5);
  const int factor = enlargement(40);
  ASSERT_GT(image.width, 40 * factor);   // room for the scale
  ASSERT_GT(image.height, 30 * factor);  // and for the notes
  const auto brightness = [&](int u, int v) {
    int sum = 0;
    for (int c = 0; c < 3; ++c) sum += image.at(u * factor + 1, v * factor + 1, c);
    return sum;
  };
  const auto is_grey = [&](int u, int v) {
    const int x = u * factor + 1, y = v * factor + 1;
    return std::abs(image.at(x, y, 0) - image.at(x, y, 2)) < 12;
  };
  EXPECT_GT(brightness(5, 15), brightness(20, 15) + 100);
  EXPECT_FALSE(is_grey(20, 15));
  EXPECT_TRUE(is_grey(32, 15));
  EXPECT_TRUE(is_grey(37, 15));
  EXPECT_GT(brightness(32, 15), brightness(37, 15) + 100);
}

TEST(ImageDepth, AFrameWithoutAnyMeasurementStillGivesAPicture) {
  Frame frame;
  frame.depth = Image16(40, 30);
  frame.depth_unit_m = 0.001;
  EXPECT_GT(image_depth(frame, 1.5).width, 40);
}

}  // namespace
}  // namespace planescope::render
