#include "core/lab/bench/scaling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/lab/synthetic/tiles.hpp"

namespace planescope::lab {
namespace {

TEST(Exponents, ArePowersLawfullyFitted) {
  const std::vector<double> x = {1, 3, 10, 200};
  std::vector<double> y;
  for (const double value : x) y.push_back(7 * std::pow(value, 1.5));
  EXPECT_NEAR(fitted_exponent(x, y), 1.5, 1e-12);
  EXPECT_NEAR(fitted_exponent(x, std::vector<double>{4, 4, 4, 4}), 0, 1e-12);
  // One that strays by as much above as another below moves nothing in the middle.
  EXPECT_NEAR(fitted_exponent(std::vector<double>{1, 2, 4, 8}, std::vector<double>{1, 3, 3, 8}),
              0.9, 0.1);
}

TEST(Exponents, AreNotToldFromOneX) {
  EXPECT_TRUE(std::isnan(fitted_exponent(std::vector<double>{2}, std::vector<double>{5})));
  EXPECT_TRUE(std::isnan(fitted_exponent(std::vector<double>{3, 3}, std::vector<double>{5, 6})));
}

TEST(ScaledFrames, SeeTheSamePlacesWithOtherPixels) {
  Frame frame;
  frame.depth = Image16(4, 2);
  for (std::size_t i = 0; i < frame.depth.data.size(); ++i)
    frame.depth.data[i] = static_cast<std::uint16_t>(100 + i);
  frame.intrinsics = {.width = 4, .height = 2, .fx = 3, .fy = 3, .cx = 1.5, .cy = 0.5};

  const Frame larger = scaled_frame(frame, 2);
  EXPECT_EQ(larger.depth.width, 8);
  EXPECT_EQ(larger.depth.height, 4);
  EXPECT_EQ(larger.depth.at(7, 3), frame.depth.at(3, 1));
  EXPECT_EQ(larger.depth.at(2, 0), frame.depth.at(1, 0));
  EXPECT_DOUBLE_EQ(larger.intrinsics.fx, 6);
  EXPECT_DOUBLE_EQ(larger.intrinsics.cx, 3.5) << "the middle stays the middle";

  const Frame smaller = scaled_frame(frame, 0.5);
  EXPECT_EQ(smaller.depth.width, 2);
  EXPECT_EQ(smaller.depth.height, 1);
  EXPECT_EQ(smaller.depth.at(1, 0), frame.depth.at(3, 1));
  EXPECT_DOUBLE_EQ(smaller.intrinsics.cx, 0.5);
}

TEST(Tiles, AreAsManyPointsAsAreAskedForOnLevelsOfTheirOwn) {
  const PointsOnPlanes cloud = tiles(2, 500);
  EXPECT_EQ(cloud.points.size(), 500u);
  EXPECT_EQ(cloud.labels.size(), 500u);
  for (const Vec3f& p : cloud.points) {
    EXPECT_GE(p.head<2>().minCoeff(), 0);
    EXPECT_LE(p.head<2>().maxCoeff(), 5);
  }
}

TEST(Tiles, ScatteredStairsHaveTreadsAndRisers) {
  const PointsOnPlanes cloud = scattered_stairs(2000);
  EXPECT_EQ(cloud.points.size(), 2000u);
  EXPECT_GT(std::ranges::count(cloud.labels, Label::h), 100);
  EXPECT_GT(std::ranges::count(cloud.labels, Label::v), 100);
}

}  // namespace
}  // namespace planescope::lab
