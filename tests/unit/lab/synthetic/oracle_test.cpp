#include "core/lab/experiments/oracle.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace planescope::lab {
namespace {

const TruePolygon kTriangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 1};

TEST(Oracle, DistanceIsThatToThePlaneOverThePolygonAndElseToItsNearestEdgeOrCorner) {
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {0.2, 0.2, 0.5}), 0.5);
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {0.2, 0.2, -0.5}), 0.5);
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {0.5, -0.3, 0.4}), 0.5);  // beside an edge
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {1.3, 0, 0.4}), 0.5);     // beyond a corner
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {1, 1, 0}), std::sqrt(0.5));
}

TEST(Oracle, WhichWayRoundThePolygonGoesDoesNotMatter) {
  const TruePolygon reversed{{{0, 1, 0}, {1, 0, 0}, {0, 0, 0}}, 1};
  for (const Vec3d& p : {Vec3d(0.2, 0.2, 0.5), Vec3d(1, 1, 0), Vec3d(-1, 2, 3)})
    EXPECT_DOUBLE_EQ(distance_m(reversed, p), distance_m(kTriangle, p));
}

TEST(Oracle, PlanesEndWhereTheirPolygonsEnd) {
  // Two tables of one height, and the floor between them.
  const std::vector<TruePolygon> tables = {
      {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, 1},
      {{{2, 0, 1}, {3, 0, 1}, {3, 1, 1}, {2, 1, 1}}, 2},
      {{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}}, 3},
  };
  const std::vector<Vec3f> points = {
      {0.5f, 0.5f, 0.9f}, {2.5f, 0.5f, 1.1f}, {1.4f, 0.5f, 1}, {1.6f, 0.5f, 1}, {1.5f, 0.5f, 0.2f}};
  EXPECT_EQ(oracle_planes(points, tables), (std::vector<std::int32_t>{1, 2, 1, 2, 3}));
}

TEST(Oracle, TakesTheFirstOfEquallyNearPlanesAndNoneWhereACurvedPartIsNearest) {
  std::vector<TruePolygon> polygons = {
      kTriangle, kTriangle, {{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, 0}};
  polygons[1].plane = 2;
  const std::vector<Vec3f> points = {{0.2f, 0.2f, 0.1f}, {0.2f, 0.2f, 0.9f}};
  EXPECT_EQ(oracle_planes(points, polygons), (std::vector<std::int32_t>{1, 0}));
}

}  // namespace
}  // namespace planescope::lab
