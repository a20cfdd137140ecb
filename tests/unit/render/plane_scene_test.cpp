// Tests of drawing finished planes in the scene and on the image.

#include <algorithm>
#include <cmath>

#include "gl_fixture.hpp"
#include "render/paint.hpp"
#include "render/palette.hpp"
#include "render/scenes.hpp"

namespace planescope::render {
namespace {

constexpr Rgba kFill{220, 20, 20, 255}, kLine{20, 20, 220, 255};

planes::PolygonRing square(double half_m, bool hole) {
  planes::PolygonRing ring = {
      {-half_m, -half_m}, {half_m, -half_m}, {half_m, half_m}, {-half_m, half_m}};
  if (hole) std::reverse(ring.begin(), ring.end());
  return ring;
}

/// A vertical square of 60 cm across the view of front_camera(), with a missing square of 20 cm.
planes::Outline with_hole(bool known) {
  planes::Outline outline;
  outline.basis.u = Vec3d::UnitY();
  outline.basis.v = Vec3d::UnitZ();
  planes::Outline::Part& part = outline.parts.emplace_back();
  part.outer = square(0.3, false);
  (known ? part.holes : part.unknown).push_back(square(0.1, true));
  return outline;
}

PlaneShape filled(const planes::Outline& outline) {
  PlaneShape shape = plane_shapes(std::span(&outline, 1), Vec3d::Zero())[0];
  fill_shape(outline, Vec3d::Zero(), shape);
  return shape;
}

double length_m(const std::vector<Vec3f>& lines) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < lines.size(); i += 2) sum += (lines[i + 1] - lines[i]).norm();
  return sum;
}

bool says(const DrawList& list, const std::string& text) {
  return std::ranges::any_of(list.labels, [&](const DrawLabel& l) { return l.text == text; });
}

struct PlaneScenePixels : GlTest {};

TEST_F(PlaneScenePixels, AHoleIsNotCovered) {
  const Image8 empty = render(without_overlay(), front_camera());
  DrawList list = without_overlay();
  add_shape(filled(with_hole(true)), {.fill = kFill, .line = kLine, .width_px = 4, .id = 0}, list);
  const Image8 image = render(list, front_camera());
  EXPECT_EQ(pixel(image, kWidth / 2, kHeight / 2), pixel(empty, kWidth / 2, kHeight / 2));
  const double px_per_m = kHeight / (2 * std::tan(22.5 * M_PI / 180));
  const auto at = [&](double m) {
    return kWidth / 2 - static_cast<int>(std::lround(m * px_per_m));
  };
  EXPECT_EQ(pixel(image, at(0.2), kHeight / 2), kFill);
  for (const double edge_m : {0.1, 0.3}) {
    const Rgba edge = pixel(image, at(edge_m), kHeight / 2);
    EXPECT_GT(edge.b, edge.r + 60) << "a line runs around it, " << edge_m << " m from its middle";
  }
}

TEST_F(PlaneScenePixels, APlaneIsNotPickedThroughItsHole) {
  DrawList list = without_overlay();
  add_shape(filled(with_hole(true)), {.fill = kFill, .line = kLine, .width_px = 2, .id = 7}, list);
  const auto ids = renderer().render_ids(list, front_camera(), kWidth, kHeight);
  EXPECT_EQ(ids.at(kWidth / 2, kHeight / 2), 0u);
  EXPECT_EQ(ids.at(kWidth / 2 + 28, kHeight / 2), 7u);
}

TEST(PlaneScene, AnOutlineWithoutATriangulationIsDrawnByItsLines) {
  planes::Outline outline = with_hole(true);
  outline.parts[0].holes.push_back({{0.2, 0.2}, {0.25, 0.2}});  // not a valid ring
  const PlaneShape shape = filled(outline);
  EXPECT_TRUE(shape.triangles.empty());
  EXPECT_FALSE(shape.rings.empty());
}

TEST(PlaneScene, UnknownAreasAreDashedAndNotFilled) {
  const PlaneShape known = filled(with_hole(true)), unknown = filled(with_hole(false));
  EXPECT_NEAR(length_m(known.rings), 2.4 + 0.8, 1e-5);
  EXPECT_TRUE(known.unknown.empty());
  EXPECT_NEAR(length_m(unknown.rings), 2.4, 1e-5);
  EXPECT_NEAR(length_m(unknown.unknown), 0.4, 1e-5) << "half of what is around it";
  EXPECT_EQ(unknown.triangles.size(), known.triangles.size());
  DrawList list;
  add_shape(unknown, {.fill = kFill, .line = kLine, .width_px = 2, .id = 0}, list);
  ASSERT_EQ(list.lines.size(), 2u);
  EXPECT_LT(list.lines[1].colors[0].a, list.lines[0].colors[0].a);
}

TEST(PlaneScene, IsRelativeToTheScenesOrigin) {
  planes::Outline outline = with_hole(true);
  outline.origin = Vec3d(1000, 2000, 50);
  const PlaneShape shape = plane_shapes(std::span(&outline, 1), Vec3d(1000, 2000, 49))[0];
  for (const Vec3f& end : shape.rings) {
    EXPECT_EQ(end.x(), 0);
    EXPECT_NEAR(std::abs(end.z() - 1), 0.2, 0.1001);
  }
}

/// Two planes; the second is not steppable.
PlaneScene two_planes() {
  planes::FootSpace space;
  space.area = {{square(0.2, false), {}}};
  space.pieces = {square(0.2, false)};
  std::vector<planes::Foothold> footholds(2);
  for (planes::Foothold& foothold : footholds) foothold.space = space;
  footholds[0].steppable = true;
  footholds[1].why_not = "17 mm rough, limit 10";
  const std::vector<planes::Outline> outlines(2, with_hole(true));
  return plane_scene(std::vector<planes::PlaneRegion>(2), outlines, footholds, {}, Vec3d::Zero());
}

TEST(PlaneScene, FootSpaceIsGrayOnPlanesThatAreNotSteppable) {
  const PlaneScene scene = two_planes();
  EXPECT_EQ(scene.verdict(1), true);
  EXPECT_EQ(scene.verdict(2), false);
  EXPECT_EQ(scene.verdict(3), std::nullopt);
  DrawList list;
  add_foot_space(scene, Theme::dark, list);
  ASSERT_EQ(list.polygons.size(), 2u);
  EXPECT_EQ(list.polygons[0].corners.size(), 4u);
  EXPECT_GT(list.polygons[0].fill.g, list.polygons[0].fill.r + 40);
  EXPECT_NEAR(list.polygons[1].fill.g, list.polygons[1].fill.r, 10);
  ASSERT_EQ(list.lines.size(), 2u);
  EXPECT_NEAR(length_m(list.lines[0].positions), 1.6, 1e-5);
}

/// Up along x: a riser of 16 cm, a going of 28 cm, a second riser of 17 cm.
planes::Stairs two_steps() {
  planes::Flight flight;
  flight.steps = {{.tread = {2},
                   .riser = 0,
                   .rise_m = 0.16,
                   .going_m = 0,
                   .nosing = {Vec3d(1, -0.5, 0.16), Vec3d(1, 0.5, 0.16)}},
                  {.tread = {3},
                   .riser = 0,
                   .rise_m = 0.17,
                   .going_m = 0.28,
                   .nosing = {Vec3d(1.28, -0.5, 0.33), Vec3d(1.28, 0.5, 0.33)}}};
  flight.rise_m = 0.165;
  flight.going_m = 0.28;
  planes::Stairs stairs;
  stairs.flights = {flight};
  return stairs;
}

TEST(PlaneScene, StepsShowRiseAndGoing) {
  PlaneScene scene;
  scene.stairs = two_steps();
  scene.origin = Vec3d(1, 0, 0);
  DrawList list;
  add_stairs(scene, Theme::light, list);
  EXPECT_TRUE(says(list, "rise 160 mm")) << "there is no nosing before the first";
  EXPECT_TRUE(says(list, "rise 170 mm, going 280 mm"));
  ASSERT_EQ(list.lines.size(), 2u);
  EXPECT_LT((list.lines[1].positions[0] - Vec3f(0.28f, -0.5f, 0.33f)).norm(), 1e-5);
  ASSERT_EQ(list.arrows.size(), 1u);
  EXPECT_GT(list.arrows[0].to.x(), list.arrows[0].from.x() + 0.5) << "uphill";
}

TEST(PlaneScene, KerbsAndRampsAreLabeled) {
  PlaneScene scene;
  scene.centroids = {Vec3f(0, 0, 0), Vec3f(1, 2, 0.3f)};
  planes::Kerb kerb;
  kerb.rise_m = 0.12;
  scene.stairs.kerbs = {kerb};
  planes::SlopingPlane ramp;
  ramp.plane = 2;
  ramp.slope_deg = 7;
  ramp.rise_m = 0.1;
  ramp.run_m = 0.8;
  scene.stairs.ramps = {ramp};
  DrawList list;
  add_stairs(scene, Theme::light, list);
  EXPECT_TRUE(says(list, "kerb, rise 120 mm"));
  EXPECT_TRUE(says(list, "ramp 7°, rise 100 mm"));
  EXPECT_LT(((list.arrows[1].from + list.arrows[1].to) / 2 - scene.centroids[1]).norm(), 1e-5);
}

// ---- Pictures on the pixels of a depth frame ----

// A wall at 1 m that fills the image as plane 1, except for a column of plane 2 at the right.
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

TEST(RegionImage, DepthPixelsLeaveNoHolesInALargerColorImage) {
  WallFrame wall;
  wall.frame.color = Image8(160, 120, 3, 128);
  wall.frame.color_intrinsics = {160, 120, 130, 130, 80, 60};
  wall.frame.T_color_depth.translation() = Vec3d(0.05, 0, 0);
  const RegionImage regions = regions_on_color(wall.frame, wall.result);
  ASSERT_EQ(regions.width, 160);
  // The wall spans -0.5 .. 0.475 m and -0.375 .. 0.35 m; in the color image it starts at u 21.5, v
  // 11.25.
  int holes = 0;
  for (int v = 14; v < 102; ++v)
    for (int u = 25; u < 145; ++u) holes += regions.at(u, v) == 0;
  EXPECT_EQ(holes, 0);
  EXPECT_EQ(regions.at(5, 60), 0);
  EXPECT_EQ(regions.at(60, 60), 1);
  EXPECT_EQ(regions.at(140, 60), 2);  // plane 2 starts at (0.25 - 0.0125 + 0.05) * 130 + 80 = 117
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
  for (int y = 5; y < 35; ++y)  // an L, whose centroid is near its inner corner
    for (int x = 5; x < 55; ++x)
      if (x < 25 || y >= 25) regions.at(x, y) = 1;
  const auto points = interior_points(regions, 2);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(regions.at(points[0].x, points[0].y), 1);
  EXPECT_NEAR(points[0].x, 15, 3);
  EXPECT_GE(points[0].depth_px, 9);
  EXPECT_EQ(points[1].depth_px, 0);  // plane 2 is not in the image
}

TEST(ImageOverlay, TintsPlanesOfTheAlignedColorImageOnly) {
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

TEST(ImageOverlay, WithoutCalibratedColorTheDepthIsShaded) {
  WallFrame wall;
  wall.frame.color = Image8(80, 60, 3, 255);  // neither aligned nor calibrated
  const Image8 image = image_overlay(wall.frame, wall.result, {});
  EXPECT_EQ(image.width, 40 * enlargement(40));
}

TEST(ImageDepth, NearAndFarDifferAndUnmeasuredPixelsAreGray) {
  WallFrame wall;
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 10; ++u) wall.frame.depth.at(u, v) = 500;
    for (int u = 30; u < 35; ++u) wall.frame.depth.at(u, v) = 0;
    for (int u = 35; u < 40; ++u) wall.frame.depth.at(u, v) = 4000;
  }
  const Image8 image = image_depth(wall.frame, 1.5);
  const int factor = enlargement(40);
  ASSERT_GT(image.width, 40 * factor);   // room for the scale
  ASSERT_GT(image.height, 30 * factor);  // and for the annotations
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
