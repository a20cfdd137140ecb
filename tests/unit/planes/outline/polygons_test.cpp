// Tests of polygon operations: area, union, inset, triangulation and largest circle.

#include "core/planes/outline/polygons.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/model/error.hpp"
#include "core/model/plane.hpp"
#include "support/polygon_scenes.hpp"

namespace planescope::planes {
namespace {

PolygonRing rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}
PolygonRing reversed(PolygonRing ring) {
  std::reverse(ring.begin(), ring.end());
  return ring;
}

/// 3 m by 2 m with a hole of 1 m by 0.5 m.
Polygons frame() { return {{rectangle(0, 0, 3, 2), {reversed(rectangle(1, 1, 2, 1.5))}}}; }

TEST(Polygons, AreaExcludesHoles) { EXPECT_DOUBLE_EQ(area(frame()), 5.5); }

TEST(Polygons, AreInvalidIfRingsCross) {
  EXPECT_TRUE(is_valid(frame()));
  const Polygon crossed{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, {}};
  EXPECT_FALSE(is_valid({crossed}));
  EXPECT_TRUE(is_valid(repaired(crossed)));
  EXPECT_DOUBLE_EQ(area(repaired(crossed)), 0.5);
}

TEST(Polygons, SimplifyingRemovesCornersAndAddsNone) {
  const Polygons stairs{{{{0, 0}, {1, 0}, {1, 0.004}, {2, 0.004}, {2, 1}, {0, 1}}, {}}};
  const Polygons simple = simplified(stairs, 0.01);
  ASSERT_EQ(simple.size(), 1u);
  EXPECT_EQ(simple[0].outer.size(), 4u);
  for (const Vec2d& corner : simple[0].outer)
    EXPECT_NE(std::ranges::find(stairs[0].outer, corner), stairs[0].outer.end());
}

TEST(Polygons, CombineWithHoles) {
  const Polygons hole{{rectangle(1, 1, 2, 1.5), {}}};
  EXPECT_DOUBLE_EQ(area(united(frame(), hole)), 6);
  EXPECT_TRUE(common(frame(), hole).empty());
  EXPECT_DOUBLE_EQ(area(common(frame(), {{rectangle(0, 0, 1.5, 2), {}}})), 2.75);
}

TEST(Polygons, ThatNearlyCoincideAreCombinedCorrectly) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const Polygons polygons = test::random_polygons(random);
    for (const Triangle& triangle : triangulated(polygons)) {
      const Polygons corner = {{{triangle.begin(), triangle.end()}, {}}};
      EXPECT_NEAR(area(common(corner, polygons)), area(corner), 1e-8);
      EXPECT_NEAR(area(without(corner, polygons)), 0, 1e-8);
      EXPECT_NEAR(area(united(corner, polygons)), area(polygons), 1e-8);
    }
  }
}

TEST(Polygons, RejectAnInvalidRingAndFreeTheirMemory) {  // checked by the address sanitizer
  const Polygon wrong{rectangle(0, 0, 3, 2), {reversed(rectangle(1, 1, 2, 1.5)), {{1, 1}}}};
  EXPECT_THROW(is_valid({wrong}), Error);
  EXPECT_THROW(united(frame(), {{rectangle(0, 0, 1, 1), {}}, wrong}), Error);
  EXPECT_THROW(is_valid({{{}, {}}}), Error);
}

TEST(Polygons, AnInsetAvoidsBordersAndHoles) {
  const Polygons inside = inset(frame(), 0.2);
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_EQ(inside[0].outer.size(), 4u);
  ASSERT_EQ(inside[0].holes.size(), 1u);
  EXPECT_EQ(inside[0].holes[0].size(), 4u) << "a corner stays one corner";
  EXPECT_NEAR(area(inside), 2.6 * 1.6 - 1.4 * 0.9, 1e-9);
  EXPECT_TRUE(inset(frame(), 1).empty());
}

TEST(Polygons, TrianglesCoverThemWithTheSameOrientation) {
  double sum = 0;
  for (const Triangle& triangle : triangulated(frame())) {
    EXPECT_GT(polygon_area(triangle), 0);
    sum += polygon_area(triangle);
  }
  EXPECT_NEAR(sum, 5.5, 1e-12);
  EXPECT_TRUE(triangulated({}).empty());
}

TEST(Polygons, TheLargestCircleIsAsFarFromHolesAsFromBorders) {
  const Circle circle = largest_circle({{rectangle(0, 0, 3, 2), {}}}, 1e-3);
  EXPECT_NEAR(circle.radius_m, 1, 2e-3);
  EXPECT_NEAR(largest_circle(frame(), 1e-3).radius_m, 0.586, 2e-3);
  EXPECT_EQ(largest_circle({}, 1e-3).radius_m, 0);
}

// GEOS 3.11 finds no triangulation without our preparation.
TEST(Polygons, WithAlignedCornersAreTriangulated) {
  Polygon cells{{{2, 1},
                 {11, 1},
                 {11, 4},
                 {10, 4},
                 {10, 6},
                 {11, 6},
                 {11, 7},
                 {9, 7},
                 {9, 8},
                 {1, 8},
                 {1, 4},
                 {2, 4}},
                {{{4, 2}, {3, 2}, {3, 3}, {4, 3}},
                 {{6, 2}, {5, 2}, {5, 4}, {7, 4}, {7, 3}, {6, 3}},
                 {{4, 4}, {3, 4}, {3, 5}, {4, 5}},
                 {{3, 6}, {2, 6}, {2, 7}, {3, 7}},
                 {{8, 6}, {7, 6}, {7, 7}, {8, 7}}}};
  std::vector<PolygonRing*> rings = {&cells.outer};
  for (PolygonRing& hole : cells.holes) rings.push_back(&hole);
  std::vector<Vec2d> corners;
  for (PolygonRing* ring : rings)
    for (Vec2d& corner : *ring) corners.emplace_back(corner *= 0.02);
  ASSERT_TRUE(is_valid({cells}));
  double sum = 0;
  for (const Triangle& triangle : triangulated({cells})) {
    sum += polygon_area(std::vector<Vec2d>(triangle.begin(), triangle.end()));
    for (const Vec2d& corner : triangle)
      EXPECT_NE(std::ranges::find(corners, corner), corners.end()) << "a corner of its own";
  }
  EXPECT_NEAR(sum, area(cells), 1e-12);
}

}  // namespace
}  // namespace planescope::planes
