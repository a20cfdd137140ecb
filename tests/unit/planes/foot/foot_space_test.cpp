// Tests of the area in which a foot fits on a plane, and of positions in it.

#include <gtest/gtest.h>

#include "core/planes/foot/footholds.hpp"
#include "support/polygon_scenes.hpp"

namespace planescope::planes {
namespace {

PolygonRing rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}
PolygonRing hole(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x0, y1}, {x1, y1}, {x1, y0}};
}

Outline outline_of(const Polygons& polygons) {
  Outline outline;
  outline.basis = plane_basis(Vec3d::UnitZ());
  for (const Polygon& polygon : polygons) {
    outline.parts.push_back({polygon.outer, polygon.holes, {}});
    outline.area_m2 += area(polygon);
  }
  return outline;
}

FootSpace space_of(const Outline& outline, const FootOptions& options) {
  return foot_space(outline, Places({}, 0.02), options);
}

double distance_m(const Vec2d& p, const PolygonRing& ring) {
  double least = 1e300;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2d& a = ring[i];
    const Vec2d edge = ring[(i + 1) % ring.size()] - a;
    const double along = std::clamp(edge.dot(p - a) / edge.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (a + along * edge - p).norm());
  }
  return least;
}

constexpr double kFoot_m = 0.1;
const FootOptions kFoot = {.radius_m = kFoot_m};

TEST(FootSpace, IsTheOutlineInsetByAFoot) {
  const FootSpace space = space_of(outline_of({{rectangle(0, 0, 1, 0.6), {}}}), kFoot);
  ASSERT_EQ(space.area.size(), 1u);
  const double inset_m = kFoot_m + 0.01 + 0.005;
  EXPECT_NEAR(space.area_m2, (1 - 2 * inset_m) * (0.6 - 2 * inset_m), 1e-9);
  EXPECT_EQ(space.pieces.size(), 1u);
}

TEST(FootSpace, IsEmptyIfTheFootDoesNotFit) {
  const FootSpace space = space_of(outline_of({{rectangle(0, 0, 1, 0.2), {}}}), kFoot);
  EXPECT_TRUE(space.area.empty());
  EXPECT_TRUE(space.pieces.empty());
}

TEST(FootSpace, IsSplitByAThinNeck) {
  Polygons plates = {{rectangle(0, 0, 0.5, 0.5), {}}};
  plates = united(plates, {{rectangle(0.5, 0.2, 0.8, 0.3), {}}});
  plates = united(plates, {{rectangle(0.8, 0, 1.3, 0.5), {}}});
  EXPECT_EQ(space_of(outline_of(plates), kFoot).area.size(), 2u);
}

TEST(FootSpace, AvoidsEvenSmallHolesButNotUnmeasuredGaps) {
  const PolygonRing small = hole(0.49, 0.49, 0.51, 0.51);  // 4 cm2, compared with 314 for the foot
  Outline obstacle = outline_of({{rectangle(0, 0, 1, 1), {small}}});
  EXPECT_EQ(space_of(obstacle, kFoot).area.at(0).holes.size(), 1u);

  Outline unknown = outline_of({{rectangle(0, 0, 1, 1), {}}});
  unknown.parts[0].unknown = {small};
  EXPECT_EQ(space_of(unknown, kFoot).area.at(0).holes.size(), 0u);
  unknown.parts[0].unknown = {hole(0.45, 0.45, 0.55, 0.55)};  // 100 cm2
  EXPECT_EQ(space_of(unknown, kFoot).area.at(0).holes.size(), 1u);
  FootOptions bold = kFoot;
  bold.unknown_share = 0.5;
  EXPECT_EQ(space_of(unknown, bold).area.at(0).holes.size(), 0u);
}

TEST(FootSpace, AvoidsPositionsOffThePlane) {
  std::vector<Places::Measured> measured;  // a floor of 1 m by 1 m whose last 30 cm are 3 cm higher
  for (double x = 0.01; x < 1; x += 0.02)
    for (double y = 0.01; y < 1; y += 0.02) measured.push_back({{x, y}, x > 0.7 ? 0.03 : 0, 1});
  const Outline floor = outline_of({{rectangle(0, 0, 1, 1), {}}});
  const FootSpace space = foot_space(floor, Places(measured, 0.02), kFoot);
  ASSERT_EQ(space.area.size(), 1u);
  for (const Vec2d& corner : space.area[0].outer) EXPECT_LT(corner.x(), 0.7 - kFoot_m);
  EXPECT_GT(space.area_m2, 0.3);
}

TEST(Places, AreSplitAlongALineByDistanceAndHeight) {
  std::vector<Places::Measured> measured;
  for (int y = 0; y < 5; ++y)
    for (int x = 4; x >= 0; --x)
      if (x != 3) measured.push_back({{0.02 * x, 0.02 * y}, 0.001 * x + 0.1 * (y != 2), 1});
  const std::vector<Vec2d> cut = Places(measured, 0.02).cut({0.05, 0.05}, Vec2d::UnitX());
  ASSERT_EQ(cut.size(), 4u) << "a row, but for the place where nothing was measured";
  constexpr double kFar_m[] = {-0.04, -0.02, 0, 0.04}, kHigh_m[] = {0, 0.001, 0.002, 0.004};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(cut[i].x(), kFar_m[i], 1e-9);
    EXPECT_NEAR(cut[i].y(), kHigh_m[i], 1e-9);
  }
  EXPECT_TRUE(Places({}, 0.02).cut({0, 0}, Vec2d::UnitX()).empty());
}

TEST(FootSpace, KeepsTheWholeFootOnTheOutlineAndNeverCrashes) {
  Random random(7);
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    const Polygons polygons = test::random_polygons(random);
    const FootOptions options = {.radius_m = random.uniform(0.005, 0.15)};
    const FootSpace space = space_of(outline_of(polygons), options);
    EXPECT_TRUE(is_valid(space.area));
    EXPECT_NEAR(space.area_m2, area(space.area), 1e-12);
    double covered_m2 = 0;
    for (const PolygonRing& piece : space.pieces) {
      EXPECT_TRUE(test::is_convex(piece));
      EXPECT_NEAR(area(common({{piece, {}}}, space.area)), polygon_area(piece), 1e-9);
      covered_m2 += polygon_area(piece);
    }
    EXPECT_GE(covered_m2, 0.95 * space.area_m2 - 1e-12);
    const auto keeps_off = [&](const PolygonRing& ring) {
      for (const Vec2d& corner : ring)
        for (const Polygon& polygon : polygons) {
          EXPECT_GE(distance_m(corner, polygon.outer), options.radius_m);
          for (const PolygonRing& other : polygon.holes)
            EXPECT_GE(distance_m(corner, other), options.radius_m);
        }
    };
    for (const Polygon& polygon : space.area) {
      keeps_off(polygon.outer);
      for (const PolygonRing& ring : polygon.holes) keeps_off(ring);
    }
  }
}

}  // namespace
}  // namespace planescope::planes
