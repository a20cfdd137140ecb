#include "core/classify/neighbours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>

namespace planescope {
namespace {

std::vector<Vec3f> surface(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> at(-1, 1);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) points.emplace_back(at(random), at(random), 0.05f * at(random));
  return points;
}

std::vector<std::uint32_t> brute_force(const std::vector<Vec3f>& points, std::size_t i, int k) {
  std::vector<std::tuple<float, float, float, float, std::uint32_t>> all;
  for (std::uint32_t j = 0; j < points.size(); ++j) {
    const Vec3f &p = points[i], &q = points[j];
    const float dx = q.x() - p.x(), dy = q.y() - p.y(), dz = q.z() - p.z();
    all.emplace_back(dx * dx + dy * dy + dz * dz, q.x(), q.y(), q.z(), j);
  }
  std::sort(all.begin(), all.end());
  std::vector<std::uint32_t> row;
  for (int n = 0; n < k; ++n)
    row.push_back(n < static_cast<int>(all.size()) ? std::get<4>(all[n]) : kNoNeighbour);
  return row;
}

void expect_exact(const std::vector<Vec3f>& points, int k) {
  const auto rows = nearest_neighbours(points, k, 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<std::uint32_t> row(rows.begin() + i * k, rows.begin() + (i + 1) * k);
    ASSERT_EQ(row, brute_force(points, i, k)) << "point " << i;
  }
}

TEST(Neighbours, AreExactOnASurface) {
  for (const int k : {1, 3, 16, 50}) expect_exact(surface(1, 1500), k);
}

TEST(Neighbours, AreExactWhereDensitiesDiffer) {
  std::vector<Vec3f> points = surface(2, 600);
  for (Vec3f p : surface(3, 300)) points.push_back(p * 0.001f + Vec3f(0.5f, 0.5f, 0.5f));
  for (Vec3f p : surface(4, 20)) points.push_back(p * 300.f);
  expect_exact(points, 16);
}

TEST(Neighbours, AreExactOnARegularGridFullOfTies) {
  std::vector<Vec3f> points;
  for (int x = 0; x < 30; ++x)
    for (int y = 0; y < 30; ++y) points.emplace_back(0.02 * x, 0.02 * y, 0);
  expect_exact(points, 16);
}

TEST(Neighbours, FewOrEqualPointsAreNoTrouble) {
  EXPECT_TRUE(nearest_neighbours({}, 16, 2).empty());
  expect_exact({{1, 2, 3}}, 4);
  expect_exact({{1, 2, 3}, {4, 5, 6}}, 4);
  expect_exact(std::vector<Vec3f>(40, Vec3f(1, 1, 1)), 16);
}

TEST(Neighbours, AreTheSameForAnyThreadCount) {
  const auto points = surface(5, 3000);
  const auto one = nearest_neighbours(points, 16, 1);
  EXPECT_EQ(one, nearest_neighbours(points, 16, 2));
  EXPECT_EQ(one, nearest_neighbours(points, 16, 8));
}

}  // namespace
}  // namespace planescope
