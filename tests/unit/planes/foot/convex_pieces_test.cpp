// Tests of dividing polygons into convex pieces.

#include <gtest/gtest.h>

#include "core/planes/outline/polygons.hpp"
#include "support/polygon_scenes.hpp"

namespace planescope::planes {
namespace {

double area_of(const std::vector<PolygonRing>& pieces) {
  double sum = 0;
  for (const PolygonRing& piece : pieces) sum += polygon_area(piece);
  return sum;
}

TEST(ConvexPieces, OfAConvexPolygonIsOne) {
  const Polygons square = {{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {}}};
  const auto pieces = convex_pieces(square);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_DOUBLE_EQ(polygon_area(pieces[0]), 1);
}

TEST(ConvexPieces, AreTwoForAnLAndFourForASquareWithASquareHole) {
  EXPECT_EQ(convex_pieces({{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {}}}).size(), 2u);
  EXPECT_EQ(convex_pieces({{{{0, 0}, {3, 0}, {3, 3}, {0, 3}}, {{{1, 1}, {1, 2}, {2, 2}, {2, 1}}}}})
                .size(),
            4u);
}

TEST(ConvexPieces, OmitANotchRatherThanSplit) {
  // 1 m by 1 m, with a tooth of 2 cm by 2 cm on one side.
  const Polygons toothed = {
      {{{0, 0}, {1, 0}, {1, 0.5}, {1.02, 0.5}, {1.02, 0.52}, {1, 0.52}, {1, 1}, {0, 1}}, {}}};
  EXPECT_EQ(convex_pieces(toothed).size(), 1u);
}

TEST(ConvexPieces, AreConvexInsideDisjointAndCoverAlmostAll) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    const Polygons polygons = test::random_polygons(random);
    const auto pieces = convex_pieces(polygons);
    for (const PolygonRing& piece : pieces) {
      EXPECT_TRUE(test::is_convex(piece));
      EXPECT_NEAR(area(common({{piece, {}}}, polygons)), polygon_area(piece), 1e-9);
    }
    for (std::size_t a = 0; a < pieces.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_LT(area(common({{pieces[a], {}}}, {{pieces[b], {}}})), 1e-9);
    EXPECT_GE(area_of(pieces), 0.95 * area(polygons) - 1e-12);
  }
}

TEST(ConvexPieces, OfNothingAreNone) { EXPECT_TRUE(convex_pieces({}).empty()); }

}  // namespace
}  // namespace planescope::planes
