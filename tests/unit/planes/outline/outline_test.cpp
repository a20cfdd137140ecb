// Tests of plane outlines: holes, gaps, occlusion and lens distortion.

#include "core/planes/outline/outline.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/planes/cloud/camera.hpp"
#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

constexpr double kCell_m = 0.02;

bool in(double x, double y, double x0, double y0, double x1, double y1) {
  return x >= x0 && x < x1 && y >= y0 && y < y1;
}

/// A wall 1 m ahead, with (x, y) in meters on it; `seen_m` determines the depth along each ray.
Frame wall(const std::function<double(double, double)>& seen_m) {
  return test::depth_frame(seen_m, 0.0005);
}

Outline outline_of_wall(const Frame& frame) {
  const FrameResult result = test::result_of(frame);
  const int id = test::plane_at(result, 320, 60);
  EXPECT_GT(id, 0);
  const std::vector<Outline> outlines = outlines_of(frame, result, kCell_m);
  EXPECT_EQ(outlines.size(), result.segmentation.planes.size());
  return outlines[static_cast<std::size_t>(id) - 1];
}

/// IoU with a polygon on the wall: y points down in the image, z up in the world.
double iou_on_wall(const Outline& outline, const Polygon& truth) {
  const auto onto_image = [&](PolygonRing ring) {
    for (Vec2d& p : ring) {
      const Vec3d world = outline.world(p);  // x forward, y left, z up
      p = {-world.y(), -world.z()};
    }
    return ring;
  };
  Polygons seen;
  for (const Polygon& polygon : polygons_of(outline)) {
    Polygon& turned = seen.emplace_back(Polygon{onto_image(polygon.outer), {}});
    for (const PolygonRing& hole : polygon.holes) turned.holes.push_back(onto_image(hole));
  }
  const Polygons all = {truth};
  return area(common(seen, all)) / area(united(seen, all));
}

const PolygonRing kView = {{-0.8, -0.6}, {0.8, -0.6}, {0.8, 0.6}, {-0.8, 0.6}};
const PolygonRing kWindow = {{-0.2, -0.1}, {-0.2, 0.3}, {0.3, 0.3}, {0.3, -0.1}};

TEST(Outline, HasTheHoleThatTheSensorSawThrough) {
  const Outline outline = outline_of_wall(
      wall([](double x, double y) { return in(x, y, -0.2, -0.1, 0.3, 0.3) ? 2.5 : 1.0; }));
  ASSERT_EQ(outline.parts.size(), 1u);
  EXPECT_EQ(outline.parts[0].holes.size(), 1u);
  EXPECT_TRUE(outline.parts[0].unknown.empty());
  EXPECT_GT(iou_on_wall(outline, {kView, {kWindow}}), 0.98);
  EXPECT_NEAR(outline.area_m2, 1.6 * 1.2 - 0.5 * 0.4, 0.02);
}

TEST(Outline, DistinguishesUnmeasuredAreasFromHoles) {
  const Outline outline = outline_of_wall(
      wall([](double x, double y) { return in(x, y, -0.2, -0.1, 0.3, 0.3) ? 0.0 : 1.0; }));
  ASSERT_EQ(outline.parts.size(), 1u);
  EXPECT_TRUE(outline.parts[0].holes.empty());
  EXPECT_EQ(outline.parts[0].unknown.size(), 1u);
  EXPECT_NEAR(outline.area_m2, 1.6 * 1.2 - 0.5 * 0.4, 0.02);
}

TEST(Outline, ClosesSmallUnmeasuredGaps) {
  const Outline outline = outline_of_wall(wall([](double x, double y) {
    return std::fmod(x + 2, 0.2) < 0.02 && std::fmod(y + 2, 0.2) < 0.02 ? 0.0 : 1.0;
  }));
  ASSERT_EQ(outline.parts.size(), 1u);
  EXPECT_TRUE(outline.parts[0].unknown.empty());
  EXPECT_NEAR(outline.area_m2, 1.6 * 1.2, 0.01);
}

TEST(Outline, DoesNotCoverObjectsInFrontOfThePlane) {
  // A cable 3 cm wide.
  const Outline outline =
      outline_of_wall(wall([](double x, double) { return std::abs(x - 0.4) < 0.015 ? 0.8 : 1.0; }));
  ASSERT_EQ(outline.parts.size(), 2u);
  EXPECT_NEAR(outline.area_m2, (1.6 - 0.03) * 1.2, 0.02);
}

TEST(Outline, FollowsTheBordersOfADistortedImage) {
  Frame frame = wall([](double, double) { return 1.0; });
  frame.intrinsics.distortion = Distortion::brown_conrady;
  frame.intrinsics.coefficients = {-0.15, 0.05, 0, 0, 0};
  const Outline outline = outline_of_wall(frame);
  const auto at = [&](double u, double v) {
    return pixel_to_ray(frame.intrinsics, u - 0.5, v - 0.5);
  };
  PolygonRing border;
  for (int u = 0; u < 640; ++u) border.push_back(at(u, 0));
  for (int v = 0; v < 480; ++v) border.push_back(at(640, v));
  for (int u = 640; u > 0; --u) border.push_back(at(u, 480));
  for (int v = 480; v > 0; --v) border.push_back(at(0, v));
  EXPECT_GT(iou_on_wall(outline, {border, {}}), 0.985);
}

TEST(Outline, UsesOnlyPointsAtGrazingAngles) {
  // A floor 10 cm below the camera, seen up to 3.9 m, where rays meet it at about one degree.
  const Frame frame = test::depth_frame(
      [](double, double y) { return y > 0.02 ? std::min(0.1 / y, 3.9) : 3.9; }, 0);
  const FrameResult result = test::result_of(frame);
  const int floor = test::plane_at(result, 320, 470);
  ASSERT_GT(floor, 0);
  const std::vector<Outline> outlines = outlines_of(frame, result, kCell_m);
  EXPECT_GT(outlines[static_cast<std::size_t>(floor) - 1].area_m2, 0.01);
  for (const Outline& outline : outlines) {
    EXPECT_TRUE(is_valid(polygons_of(outline)));
    for (const Outline::Part& part : outline.parts)
      for (const Vec2d& corner : part.outer) EXPECT_LT(outline.world(corner).norm(), 10);
  }
}

TEST(Outline, IsTheSameForCloudsByCells) {
  Frame frame;
  frame.cloud = PointSet{};
  frame.gravity = Gravity{-Vec3d::UnitZ(), GravitySource::option, 1, "down"};
  Random random(5);
  for (int i = 0; i < 40'000; ++i) {  // a floor of 2 m by 1 m with a hole
    const double x = random.uniform(0, 2), y = random.uniform(0, 1);
    if (!in(x, y, 0.5, 0.3, 1, 0.7))
      frame.cloud->points.emplace_back(x, y, 0.001 * random.normal());
  }
  const FrameResult result = test::result_of(frame);
  ASSERT_EQ(result.segmentation.planes.size(), 1u);
  const Outline outline = outlines_of(frame, result, kCell_m)[0];
  ASSERT_EQ(outline.parts.size(), 1u);
  EXPECT_EQ(outline.parts[0].unknown.size(), 1u) << "nobody knows what a cloud's sensor saw";
  EXPECT_NEAR(outline.area_m2, 2 * 1 - 0.5 * 0.4, 0.06);
}

TEST(Outline, IsValidForAnyPixels) {
  Random random(11);
  const Frame frame = wall([](double, double) { return 1.0; });
  FrameResult result = test::result_of(frame);
  ASSERT_GE(result.segmentation.planes.size(), 1u);
  for (int trial = 0; trial < 8; ++trial) {
    // Squares from one pixel in size that touch at their corners, with random pixels removed.
    const std::uint32_t edge = 1 + static_cast<std::uint32_t>(trial);
    const double share = random.uniform(0.2, 0.98);
    std::fill(result.plane_of.begin(), result.plane_of.end(), 0);
    for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
      const std::uint32_t x = result.cloud.source[i] % 640, y = result.cloud.source[i] / 640;
      const bool black = (x / edge + y / edge) % 2 == 0 || (x / 20 + y / 20) % 3 == 0;
      if (x < 40 && y < 30 && black && random.uniform(0, 1) < share) result.plane_of[i] = 1;
    }
    const Outline outline = outlines_of(frame, result, kCell_m, {.least_m2 = 0})[0];
    EXPECT_TRUE(is_valid(polygons_of(outline)));
    EXPECT_NEAR(outline.area_m2, area(polygons_of(outline)), 1e-9);
  }
}

}  // namespace
}  // namespace planescope::planes
