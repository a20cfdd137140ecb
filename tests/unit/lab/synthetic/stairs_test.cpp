// Tests of random numbers and farthest point sampling.

#include "core/lab/synthetic/stairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lab/synthetic/repeatable.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {
namespace {

// ---- Random numbers ----

TEST(Random, ValuesNeverChange) {
  EXPECT_EQ(mix_bits(0), 0xe220a8397b1dcdafu);  // the published first value of splitmix64
  EXPECT_EQ(random_uniform(1, 2, 3), random_uniform(1, 2, 3));
  EXPECT_NE(random_bits(1, 2, 3), random_bits(1, 3, 2));
  EXPECT_NE(random_bits(1, 2, 3), random_bits(2, 1, 3));
}

TEST(Random, NormalValuesHaveTheMomentsOfANormalDistribution) {
  constexpr int kCount = 200000;
  double sum = 0, squares = 0, fourth = 0, largest = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random_normal(7, 1, i);
    largest = std::max(largest, std::abs(x));
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_LT(largest, 4.91);
  EXPECT_NEAR(sum / kCount, 0, 0.01);
  EXPECT_NEAR(squares / kCount, 1, 0.01);
  // the tails of Irwin-Hall of 8 are slightly lighter
  EXPECT_NEAR(fourth / kCount, 3 - 1.2 / 8, 0.06);
}

// ---- Surfaces ----

std::vector<std::uint32_t> plain_loop(const std::vector<Vec3f>& points, std::size_t count) {
  std::vector<float> distance2(points.size(), std::numeric_limits<float>::max());
  std::vector<std::uint32_t> chosen;
  while (chosen.size() < std::min(count, points.size())) {
    const auto farthest = std::max_element(distance2.begin(), distance2.end());
    chosen.push_back(static_cast<std::uint32_t>(farthest - distance2.begin()));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3f d = points[i] - points[chosen.back()];
      distance2[i] = std::min(distance2[i], d.x() * d.x() + d.y() * d.y() + d.z() * d.z());
    }
  }
  return chosen;
}

std::vector<Vec3f> random_points(int count, const Vec3d& size, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    points.push_back(Vec3d(x, y, z).cwiseProduct(size).cast<float>());
  }
  return points;
}

TEST(FarthestPoints, MatchThePlainLoopInOrder) {
  for (const Vec3d& size : {Vec3d(1, 1, 1), Vec3d(2, 0.5, 0), Vec3d(1, 0, 0)}) {
    const auto points = random_points(5000, size, 1);
    EXPECT_EQ(farthest_points(points, 1500), plain_loop(points, 1500));
  }
}

TEST(FarthestPoints, TheFirstOfEquallyFarOnesIsSelected) {
  std::vector<Vec3f> grid;
  for (int i = 0; i < 4096; ++i)
    grid.push_back(Eigen::Vector3i(i % 16, i / 16 % 16, i / 256).cast<float>() / 8.f);
  EXPECT_EQ(farthest_points(grid, 4096), plain_loop(grid, 4096));
  auto twice = random_points(300, Vec3d(1, 1, 1), 2);
  twice.insert(twice.end(), twice.begin(), twice.end());
  EXPECT_EQ(farthest_points(twice, 600), plain_loop(twice, 600));
}

TEST(FarthestPoints, AllAreSelectedIfThereAreFewer) {
  EXPECT_TRUE(farthest_points({}, 3).empty());
  EXPECT_TRUE(farthest_points(random_points(3, Vec3d(1, 1, 1), 3), 0).empty());
  EXPECT_EQ(farthest_points(random_points(3, Vec3d(1, 1, 1), 3), 9).size(), 3u);
}

}  // namespace
}  // namespace planescope::lab
