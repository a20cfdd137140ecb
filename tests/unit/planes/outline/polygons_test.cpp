#include "core/planes/outline/polygons.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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

TEST(Polygons, AreaIsWithoutHoles) { EXPECT_DOUBLE_EQ(area(frame()), 5.5); }

TEST(Polygons, AreNotValidWhereRingsCross) {
  EXPECT_TRUE(is_valid(frame()));
  const Polygon crossed{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, {}};
  EXPECT_FALSE(is_valid({crossed}));
  EXPECT_TRUE(is_valid(repaired(crossed)));
  EXPECT_DOUBLE_EQ(area(repaired(crossed)), 0.5);
}

TEST(Polygons, SimplifyingLeavesCornersOutAndMakesNone) {
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

}  // namespace
}  // namespace planescope::planes
