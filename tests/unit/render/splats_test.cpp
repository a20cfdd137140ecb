#include "render/splats.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/model/random.hpp"

namespace planescope::render {
namespace {

constexpr int kSide = 96;

View front_view() {
  Camera camera;
  camera.eye = {-1, 0, 0};
  camera.target = Vec3d::Zero();
  return make_view(camera, kSide, kSide);
}

DrawPoints scattered(int count) {
  Random random(7);
  DrawPoints points;
  points.size_m = 0.08f;
  points.max_px = 40;
  for (int i = 0; i < count; ++i) {
    const auto next = [&] { return static_cast<float>(random.uniform()); };
    const float x = 0.4f * next(), y = next() - 0.5f, z = next() - 0.5f;
    points.positions.emplace_back(x, y, z);
    points.colors.push_back({static_cast<std::uint8_t>(i), 90, 200, 255});
  }
  return points;
}

Image8 picture(const std::vector<DrawPoints>& clouds) {
  return paint(splat(clouds, front_view()), clouds, theme_colors(Theme::light));
}

TEST(Splats, OrderOfPointsDoesNotMatter) {
  const DrawPoints points = scattered(300);
  DrawPoints reversed = points;
  std::ranges::reverse(reversed.positions);
  std::ranges::reverse(reversed.colors);
  const Image8 one = picture({points}), other = picture({reversed});
  int differing = 0;  // where two are equally far the later one is seen
  for (std::size_t i = 0; i < one.data.size(); ++i) differing += one.data[i] != other.data[i];
  EXPECT_LE(differing, 30);
}

TEST(Splats, PointsCoverAPixelOnceAtMost) {
  const std::vector<DrawPoints> clouds = {scattered(300)};
  const SplatLayer layer = splat(clouds, front_view());
  const SplatLayer::Part* part = layer.parts.data();
  int covered = 0;
  for (std::size_t i = 0; i < layer.counts.size(); ++i) {
    float sum = layer.bare[i];
    for (int k = 0; k < layer.counts[i]; ++k) sum += (part++)->share;
    EXPECT_LE(sum, 1.0001f);
    EXPECT_LE(layer.counts[i], 4);
    if (layer.counts[i] == 0) {
      EXPECT_EQ(layer.distances[i], std::numeric_limits<float>::infinity());
      EXPECT_EQ(layer.light[i], 1);
    } else {
      EXPECT_GE(sum, 0.85f);  // the rim is darker
      ++covered;
    }
  }
  EXPECT_EQ(part, layer.parts.data() + layer.parts.size());
  EXPECT_GT(covered, 1000);
}

TEST(Splats, OtherColorsDoNotChangeTheShapes) {
  DrawPoints points = scattered(10);
  std::vector<DrawPoints> other = {points};
  for (Rgba& color : other[0].colors) color = {1, 2, 3, 255};
  EXPECT_TRUE(same_shapes({points}, other));
  other[0].colors[3].a = 128;
  EXPECT_FALSE(same_shapes({points}, other));
  other = {points, points};
  EXPECT_FALSE(same_shapes({points}, other));
  other = {points};
  other[0].positions[0].x() += 0.01f;
  EXPECT_FALSE(same_shapes({points}, other));
}

TEST(Splats, DepthGrowsFromTheNearPlaneToTheFarOne) {
  DrawPoints points;
  points.positions = {{0, 0, 0}, {0.5f, 0.2f, 0}};
  points.colors.assign(2, {200, 0, 0, 255});
  const View view = front_view();
  const SplatLayer layer = splat({points}, view);
  const std::vector<std::uint32_t> depth = depths(layer, view);
  EXPECT_EQ(depth.front(), 0xffffffffu);
  EXPECT_EQ(std::ranges::count_if(depth, [](std::uint32_t d) { return d == 0; }), 0);
  const std::size_t middle = kSide / 2 * kSide + kSide / 2;
  EXPECT_NEAR(layer.distances[middle], 1, 0.02);
  // 1 m, between planes at 0.02 m and 200 m.
  EXPECT_NEAR(depth[middle] / 4294967296.0, (1 - 0.02 / layer.distances[middle]) / (1 - 0.0001),
              1e-6);
}

}  // namespace
}  // namespace planescope::render
