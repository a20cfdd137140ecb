#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/lab/training/training_set.hpp"

namespace planescope::lab {
namespace {

/// A level square metre of 64 x 64 points, labelled as a chessboard so that every point can be
/// told apart from its neighbours.
planes::LabelledCloud board() {
  planes::LabelledCloud cloud{"board", {}, {}};
  for (int i = 0; i < 4096; ++i) {
    const int x = i % 64, y = i / 64;
    cloud.points.emplace_back(static_cast<float>(x) / 63, static_cast<float>(y) / 63, 0.5f);
    cloud.labels.push_back((x + y) % 2 == 0 ? Label::h : Label::v);
  }
  return cloud;
}

AugmentOptions nothing() {
  AugmentOptions options;
  options.uniform_noise_m = 0;
  options.clusters = 0;
  options.points = 0;
  options.yaw_deg = 0;
  return options;
}

TEST(Augment, WithNothingAskedForTheCloudStaysAsItIs) {
  const planes::LabelledCloud cloud = board(), same = augment(cloud, nothing(), 3);
  EXPECT_EQ(same.kind, cloud.kind);
  EXPECT_EQ(same.points, cloud.points);
  EXPECT_EQ(same.labels, cloud.labels);
}

TEST(Augment, TheSameSeedGivesTheSameCloudAndAnotherOneAnother) {
  AugmentOptions options;
  options.gaussian_noise_m = 0.003;
  options.tilt_deg = 3;
  options.thinning = 0.5;
  const planes::LabelledCloud a = augment(board(), options, 1), b = augment(board(), options, 1);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_NE(a.points, augment(board(), options, 2).points);
}

TEST(Augment, UniformNoiseReachesItsBoundEitherWayAndNoFarther) {
  AugmentOptions options = nothing();
  options.uniform_noise_m = 0.01;
  const planes::LabelledCloud cloud = board(), noisy = augment(cloud, options, 1);
  EXPECT_EQ(noisy.labels, cloud.labels);
  Vec3f least = Vec3f::Zero(), most = Vec3f::Zero();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    least = least.cwiseMin(noisy.points[i] - cloud.points[i]);
    most = most.cwiseMax(noisy.points[i] - cloud.points[i]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(least[axis], -0.01, 1e-4);
    EXPECT_NEAR(most[axis], 0.01, 1e-4);
  }
}

TEST(Augment, GaussianNoiseVariesAmongCloudsUpToItsDeviation) {
  AugmentOptions options = nothing();
  options.gaussian_noise_m = 0.003;
  double least = 1, most = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    double squares = 0;
    const planes::LabelledCloud noisy = augment(board(), options, seed);
    for (const Vec3f& p : noisy.points) squares += std::pow(p.z() - 0.5, 2);
    const double deviation = std::sqrt(squares / 4096);
    least = std::min(least, deviation);
    most = std::max(most, deviation);
  }
  EXPECT_LT(least, 0.0006);
  EXPECT_GT(most, 0.0024);
  EXPECT_LT(most, 0.0031);
}

TEST(Augment, YawTurnsAboutTheVerticalOnly) {
  AugmentOptions options = nothing();
  options.yaw_deg = 180;
  const planes::LabelledCloud cloud = board(), turned = augment(cloud, options, 5);
  double moved = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_EQ(turned.points[i].z(), 0.5f);
    EXPECT_NEAR(turned.points[i].norm(), cloud.points[i].norm(), 1e-5);
    moved = std::max<double>(moved, (turned.points[i] - cloud.points[i]).norm());
  }
  EXPECT_GT(moved, 0.1);
}

TEST(Augment, TiltStaysWithinItsAngleAndLeavesTheLabels) {
  AugmentOptions options = nothing();
  options.tilt_deg = 5;
  double most = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const planes::LabelledCloud cloud = board(), tilted = augment(cloud, options, seed);
    EXPECT_EQ(tilted.labels, cloud.labels);
    const Vec3f u = tilted.points[63] - tilted.points[0];
    const Vec3f v = tilted.points[63 * 64] - tilted.points[0];
    const double angle = std::acos(std::min(1.f, u.cross(v).normalized().z())) * 180 / M_PI;
    most = std::max(most, angle);
  }
  EXPECT_GT(most, 3);
  EXPECT_LT(most, 5.01);
}

TEST(Augment, ClustersAreRoundHolesAndHalfOfThePointsRemain) {
  AugmentOptions options = nothing();
  options.clusters = 4;
  options.cluster_radius_m = 0.3;
  bool whole = false, holed = false;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const planes::LabelledCloud rest = augment(board(), options, seed);
    EXPECT_GE(rest.points.size(), 2048u);
    EXPECT_EQ(rest.points.size(), rest.labels.size());
    whole = whole || rest.points.size() == 4096;
    holed = holed || rest.points.size() < 3600;
  }
  EXPECT_TRUE(whole && holed);
  options.cluster_radius_m = 100;
  EXPECT_GE(augment(board(), options, 1).points.size(), 2048u);
}

TEST(Augment, KeepsTheNearestPointsToOneOfThemWithTheirLabels) {
  AugmentOptions options = nothing();
  options.points = 500;
  const planes::LabelledCloud cloud = board();
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const planes::LabelledCloud part = augment(cloud, options, seed);
    ASSERT_EQ(part.points.size(), 500u);
    for (std::size_t i = 0; i < 500; ++i) {
      const long x = std::lround(part.points[i].x() * 63), y = std::lround(part.points[i].y() * 63);
      EXPECT_EQ(part.labels[i], cloud.labels[static_cast<std::size_t>(y * 64 + x)]);
    }
    // 500 of 4096 points of a square metre: a disc of 0.2 m radius, a quarter of one of 0.4 m in a
    // corner.
    Vec3f least = part.points[0], most = part.points[0];
    for (const Vec3f& p : part.points) {
      least = least.cwiseMin(p);
      most = most.cwiseMax(p);
    }
    EXPECT_LT((most - least).maxCoeff(), 0.6);
  }
}

TEST(Augment, ThinningKeepsARandomShare) {
  AugmentOptions options = nothing();
  options.thinning = 0.25;
  std::size_t least = 4096, most = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const std::size_t count = augment(board(), options, seed).points.size();
    least = std::min(least, count);
    most = std::max(most, count);
  }
  EXPECT_NEAR(static_cast<double>(least), 0.3 * 4096, 400);
  EXPECT_NEAR(static_cast<double>(most), 0.95 * 4096, 400);
}

TEST(Augment, AnEmptyCloudStaysEmpty) {
  const planes::LabelledCloud none{"none", {}, {}};
  EXPECT_TRUE(augment(none, AugmentOptions{}, 1).points.empty());
}

}  // namespace
}  // namespace planescope::lab
