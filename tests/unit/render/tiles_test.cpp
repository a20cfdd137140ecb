#include "render/tiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace planescope::render {
namespace {

constexpr int kWidth = 200, kHeight = 100;

Tiles with(const std::vector<std::pair<Part, std::uint64_t>>& drawn) {
  Tiles tiles(kWidth, kHeight);
  for (const auto& [part, hash] : drawn) tiles.add(part, hash);
  return tiles;
}

bool holds(const std::vector<Part>& parts, int x, int y) {
  for (const Part& part : parts)
    if (x >= part.x0 && x < part.x1 && y >= part.y0 && y < part.y1) return true;
  return false;
}

const Part kLeft{10, 10, 40, 30}, kRight{150, 60, 190, 95};

TEST(Tiles, OfThePictureBeforeHaveNoChanges) {
  EXPECT_TRUE(
      with({{kLeft, 1}, {kRight, 2}}).changes_since(with({{kLeft, 1}, {kRight, 2}})).empty());
}

TEST(Tiles, ChangeWhereSomethingElseIsDrawn) {
  const auto parts = with({{kLeft, 1}, {kRight, 3}}).changes_since(with({{kLeft, 1}, {kRight, 2}}));
  EXPECT_TRUE(holds(parts, 150, 60));
  EXPECT_TRUE(holds(parts, 189, 94));
  EXPECT_FALSE(holds(parts, 39, 29));
}

TEST(Tiles, ChangeWhereSomethingWasAndWhereItIsNow) {
  const auto parts = with({{kRight, 1}}).changes_since(with({{kLeft, 1}}));
  EXPECT_TRUE(holds(parts, 10, 10));
  EXPECT_TRUE(holds(parts, 150, 60));
  EXPECT_FALSE(holds(parts, 100, 50));
}

TEST(Tiles, ChangeWhereThingsSwapTheirOrder) {
  EXPECT_TRUE(
      holds(with({{kLeft, 2}, {kLeft, 1}}).changes_since(with({{kLeft, 1}, {kLeft, 2}})), 20, 20));
}

TEST(Tiles, ChangeAllOverWhereTheSizeIsAnother) {
  const auto parts = with({}).changes_since(Tiles());
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0], (Part{0, 0, kWidth, kHeight}));
}

TEST(Tiles, PartsInReachOfEachOtherBecomeOne) {
  const Part a{0, 0, 32, 32}, b{36, 0, 60, 20}, far{150, 60, 190, 95};
  EXPECT_EQ(apart({a, b, far}, 4).size(), 3U);
  const auto two = apart({a, far, b}, 5);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_NE(std::find(two.begin(), two.end(), around(a, b)), two.end());
}

TEST(Tiles, FewerPartsStillHoldThemAll) {
  const std::vector<Part> parts = {kLeft, kRight, {60, 10, 70, 20}, {160, 10, 170, 20}};
  const auto fewer = at_most(parts, 2);
  ASSERT_EQ(fewer.size(), 2U);
  for (const Part& part : parts) {
    const auto inside = [&](const Part& room) { return common(part, room) == part; };
    EXPECT_TRUE(inside(fewer[0]) || inside(fewer[1]));
  }
}

}  // namespace
}  // namespace planescope::render
