// Tests of the nearest-neighbor grid against brute force.

#include "core/planes/classify/neighbour_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace planescope::planes {
namespace {

std::vector<Vec3f> surface(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> at(-1, 1);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) points.emplace_back(at(random), at(random), 0.05f * at(random));
  return points;
}

std::vector<Vec3f> regular_square(int edge) {
  std::vector<Vec3f> points;
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y) points.emplace_back(0.02 * x, 0.02 * y, 0);
  return points;
}

/// Difficult clouds for searches that use cells.
std::vector<std::pair<std::string, std::vector<Vec3f>>> clouds() {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<float> at(-1, 1);
  std::vector<Vec3f> clusters = surface(2, 600), volume, line, nearly_one, doubled, extremes;
  for (const Vec3f& p : surface(3, 500)) clusters.push_back(p * 1e-4f + Vec3f(0.5f, 0.5f, 0.5f));
  for (const Vec3f& p : surface(4, 20)) clusters.push_back(p * 300.f);
  for (int i = 0; i < 1000; ++i) volume.emplace_back(at(random), at(random), at(random));
  for (int i = 0; i < 500; ++i) line.push_back(Vec3f(1, 2, -3) * at(random));
  for (const Vec3f& p : surface(5, 300)) nearly_one.push_back(p * 1e-6f + Vec3f(1000, 1000, 1000));
  for (const Vec3f& p : surface(7, 400)) doubled.insert(doubled.end(), {p, p});
  doubled.insert(doubled.end(), 900, Vec3f(0.3f, 0.3f, 0));
  for (const Vec3f& p : surface(8, 100)) {
    extremes.push_back(p * 1e-25f);
    extremes.push_back(p * 3e38f);
  }
  return {{"surface", surface(1, 1500)},
          {"clusters and stragglers", clusters},
          {"volume", volume},
          {"line", line},
          {"regular square", regular_square(32)},
          {"a few float steps wide", nearly_one},
          {"duplicates", doubled},
          {"squares overflow and vanish", extremes},
          {"fewer than k", surface(9, 5)},
          {"one", {{1, 2, 3}}},
          {"none", {}}};
}

float squared_distance(const Vec3f& p, const Vec3f& q) {
  const float dx = q.x() - p.x(), dy = q.y() - p.y(), dz = q.z() - p.z();
  return dx * dx + dy * dy + dz * dz;
}

/// The k nearest neighbors by brute force, in ascending order of distance.
std::vector<std::uint32_t> brute_force(std::span<const Vec3f> points, const Vec3f& p, int k) {
  std::vector<std::pair<float, std::uint32_t>> all;
  for (std::uint32_t j = 0; j < points.size(); ++j)
    all.emplace_back(squared_distance(p, points[j]), j);
  const auto found = std::min<std::size_t>(k, all.size());
  std::partial_sort(all.begin(), all.begin() + found, all.end());
  std::vector<std::uint32_t> row(k, kNoNeighbor);
  std::transform(all.begin(), all.begin() + found, row.begin(), [](auto& a) { return a.second; });
  std::sort(row.begin(), row.end());
  return row;
}

std::vector<std::uint32_t> all_rows(const NeighborGrid& grid, int k) {
  std::vector<std::uint32_t> rows(grid.size() * k);
  grid.nearest(k, 0, grid.size(), rows.data());
  return rows;
}

void expect_exact(const NeighborGrid& grid, int k) {
  const std::vector<std::uint32_t> rows = all_rows(grid, k);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::vector<std::uint32_t> row(rows.begin() + i * k, rows.begin() + (i + 1) * k);
    ASSERT_EQ(row, brute_force(grid.points(), grid.points()[i], k)) << "k " << k << " point " << i;
  }
}

TEST(NeighborGrid, MatchesBruteForce) {
  for (const auto& [name, points] : clouds()) {
    SCOPED_TRACE(name);
    for (const int k : {1, 4, 17, 51}) expect_exact(NeighborGrid(points, k), k);
    expect_exact(NeighborGrid(points, 16).every(4), 16);
  }
}

TEST(NeighborGrid, FindsTheRequestedNumberForAnyCellSize) {
  const NeighborGrid grid(surface(1, 1200), 16);
  for (const int k : {5, 200, 1024}) expect_exact(grid, k);
}

TEST(NeighborGrid, FindsThePointNearestToAnyQuery) {
  for (const auto& [name, points] : clouds()) {
    const NeighborGrid grid(points, 16);
    std::vector<Vec3f> queries(grid.points().begin(), grid.points().end());
    for (const Vec3f& p : surface(10, 100)) queries.insert(queries.end(), {p, p * 1e3f, p * 1e30f});
    std::vector<std::uint32_t> found(queries.size());
    grid.nearest_to(queries, found.data());
    for (std::size_t i = 0; i < queries.size(); ++i)
      ASSERT_EQ(found[i], brute_force(grid.points(), queries[i], 1)[0]) << name << ", query " << i;
  }
}

TEST(NeighborGrid, HasTheSameOrderForAnyOrderOfTheInput) {
  for (const auto& [name, points] : clouds()) {
    std::vector<Vec3f> shuffled = points;
    std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937_64(11));
    const NeighborGrid grid(points, 16), other(shuffled, 16);
    EXPECT_TRUE(std::ranges::equal(grid.points(), other.points())) << name;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      ASSERT_EQ(grid.points()[i], points[grid.order()[i]]) << name;
      ASSERT_EQ(other.points()[i], shuffled[other.order()[i]]) << name;
    }
  }
}

TEST(NeighborGrid, EveryFourthPointKeepsItsPositionAndIndex) {
  const NeighborGrid grid(surface(1, 1001), 16), fourth = grid.every(4);
  ASSERT_EQ(fourth.size(), 251U);
  for (std::size_t i = 0; i < fourth.size(); ++i) {
    EXPECT_EQ(fourth.points()[i], grid.points()[4 * i]);
    EXPECT_EQ(fourth.order()[i], grid.order()[4 * i]);
  }
}

TEST(NeighborGrid, KeepsItsOrderWhenTheCloudIsScaledByAPowerOfTwo) {
  std::vector<Vec3f> points = surface(1, 2000);
  const NeighborGrid grid(points, 16);
  for (Vec3f& p : points) p *= 1024;
  EXPECT_TRUE(std::ranges::equal(grid.order(), NeighborGrid(points, 16).order()));
}

TEST(NeighborGrid, ManyEqualPointsAreSupported) {
  std::vector<Vec3f> points(200'000, Vec3f(1, 2, 3));
  points.emplace_back(1, 2, 4);
  const NeighborGrid grid(points, 16);
  std::vector<std::uint32_t> rows(grid.size() * 16), first(16);
  grid.nearest(16, 0, grid.size(), rows.data());
  std::iota(first.begin(), first.end(), 0U);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), rows.begin() + 150'000 * 16));
}

}  // namespace
}  // namespace planescope::planes
