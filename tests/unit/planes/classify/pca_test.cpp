// Tests of the PCA classifier.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "core/model/error.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {
namespace {

/// A square of 1 m, tilted about the y axis, sampled every 2 cm with 1 mm of noise.
std::vector<Vec3f> tilted(double angle_deg, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, 0.001);
  const double a = angle_deg * std::numbers::pi / 180;
  const Vec3d along(std::cos(a), 0, std::sin(a)), normal(-std::sin(a), 0, std::cos(a));
  std::vector<Vec3f> points;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j)
      points.push_back(
          (along * (i * 0.02) + Vec3d(0, j * 0.02, 0) + normal * noise(random)).cast<float>());
  return points;
}

TEST(Pca, LabelsByTheAngleToGravity) {
  const auto classifier = make_pca_classifier();
  for (const double angle_deg : {0.0, 20.0, 35.0, 55.0, 70.0, 90.0}) {
    const auto result = classifier->classify(tilted(angle_deg, 1), 1);
    const Label expected = angle_deg < 45 ? Label::h : Label::v;
    for (const Label label : result.labels) ASSERT_EQ(label, expected) << angle_deg;
    const double mean = std::accumulate(result.margins.begin(), result.margins.end(), 0.0) / 2500;
    EXPECT_NEAR(mean, std::abs(angle_deg - 45) / 45, 0.05) << angle_deg;
  }
}

TEST(Pca, GivesTheSameResultForAnyThreadCount) {
  auto points = tilted(0, 2);
  const auto wall = tilted(90, 3);
  points.insert(points.end(), wall.begin(), wall.end());
  const auto classifier = make_pca_classifier();
  const auto one = classifier->classify(points, 1);
  for (const int threads : {2, 8}) {
    const auto many = classifier->classify(points, threads);
    EXPECT_EQ(one.labels, many.labels);
    EXPECT_EQ(one.margins, many.margins);
  }
}

TEST(Pca, GivesTheSameResultForAnyOrderOfThePoints) {
  std::vector<Vec3f> points;  // exactly regular: every neighborhood has ties
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      points.emplace_back(0.02 * i, 0.02 * j, 0);
      if (j > 0) points.emplace_back(0.02 * i, 0, 0.02 * j);
    }
  std::vector<std::size_t> shuffle(points.size());
  std::iota(shuffle.begin(), shuffle.end(), 0);
  std::shuffle(shuffle.begin(), shuffle.end(), std::mt19937_64(4));
  std::vector<Vec3f> shuffled;
  for (const std::size_t i : shuffle) shuffled.push_back(points[i]);
  const auto classifier = make_pca_classifier();
  const auto straight = classifier->classify(points, 2), mixed = classifier->classify(shuffled, 2);
  for (std::size_t i = 0; i < shuffle.size(); ++i) {
    EXPECT_EQ(mixed.labels[i], straight.labels[shuffle[i]]);
    EXPECT_EQ(mixed.margins[i], straight.margins[shuffle[i]]);
  }
}

TEST(Pca, PointsWithoutANormalGetAnUncertainLabel) {
  const auto classifier = make_pca_classifier();
  EXPECT_TRUE(classifier->classify({}, 2).labels.empty());
  const auto margins_are_zero = [](const Classification& c) {
    return std::all_of(c.margins.begin(), c.margins.end(), [](float m) { return m == 0; });
  };
  for (const std::size_t n : {1, 2, 40}) {
    const auto result = classifier->classify(std::vector<Vec3f>(n, Vec3f(1, 2, 3)), 1);
    EXPECT_EQ(result.labels, std::vector<Label>(n, Label::h));
    EXPECT_TRUE(margins_are_zero(result));
  }
  std::vector<Vec3f> pole;
  for (int i = 0; i < 20; ++i) pole.emplace_back(0, 0, 0.1 * i);
  const auto result = classifier->classify(pole, 1);
  EXPECT_EQ(result.labels, std::vector<Label>(20, Label::v));
  EXPECT_TRUE(margins_are_zero(result));
}

TEST(Pca, NonFinitePointsAreUnknownAndIgnored) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<Vec3f> finite = tilted(30, 5);
  std::vector<Vec3f> points = finite;
  points.insert(points.begin() + 1000, {Vec3f(nan, 0, 0), Vec3f(0, 0, -inf)});
  const auto classifier = make_pca_classifier();
  const auto alone = classifier->classify(finite, 1);
  auto result = classifier->classify(points, 1);
  for (int bad = 0; bad < 2; ++bad) {
    EXPECT_EQ(result.labels[1000], Label::unknown);
    EXPECT_EQ(result.margins[1000], 0);
    result.labels.erase(result.labels.begin() + 1000);
    result.margins.erase(result.margins.begin() + 1000);
  }
  EXPECT_EQ(result.labels, alone.labels);
  EXPECT_EQ(result.margins, alone.margins);
}

TEST(Pca, OptionsOutOfRangeAreRejected) {
  EXPECT_THROW(make_pca_classifier({.neighbors = 2}), Error);
  EXPECT_THROW(make_pca_classifier({.max_angle_deg = 90}), Error);
}

}  // namespace
}  // namespace planescope::planes
