#include <gtest/gtest.h>

#include <limits>

#include "core/lab/synthetic/stairs.hpp"
#include "core/planes/rivals/rival_classifiers.hpp"

namespace planescope::planes {
namespace {

/// Farther from every point of another plane than 16 neighbours reach.
std::vector<bool> away_from_edges(const PointSet& cloud) {
  constexpr float kReach = 0.08f;
  std::vector<bool> away(cloud.points.size(), true);
  for (std::size_t i = 0; i < away.size(); ++i)
    for (std::size_t j = 0; j < away.size() && away[i]; ++j)
      away[i] =
          cloud.label[i] == cloud.label[j] || (cloud.points[i] - cloud.points[j]).norm() > kReach;
  return away;
}

TEST(NanoflannPca, AgreesWithOurPcaAwayFromEdges) {
  const PointSet cloud = lab::make_stairs(2, {.points = 4096}).cloud;
  const std::vector<bool> away = away_from_edges(cloud);
  const Classification rival = make_nanoflann_pca_classifier()->classify(cloud.points, 1);
  const Classification ours = make_pca_classifier()->classify(cloud.points, 1);
  int compared = 0;
  for (std::size_t i = 0; i < away.size(); ++i) {
    if (!away[i]) continue;
    ++compared;
    ASSERT_EQ(rival.labels[i], static_cast<Label>(cloud.label[i]));
    ASSERT_EQ(rival.labels[i], ours.labels[i]);
    ASSERT_NEAR(rival.margins[i], 1, 1e-3);
  }
  EXPECT_GT(compared, 1000);
}

TEST(NanoflannPca, GivesTheSameAnswerForAnyThreadCount) {
  const PointSet cloud = lab::make_stairs(1, {.points = 2048, .noise_m = 0.002}).cloud;
  const auto classifier = make_nanoflann_pca_classifier();
  const Classification one = classifier->classify(cloud.points, 1);
  const Classification four = classifier->classify(cloud.points, 4);
  EXPECT_EQ(one.labels, four.labels);
  EXPECT_EQ(one.margins, four.margins);
}

TEST(NanoflannPca, TakesCloudsSmallerThanANeighbourhoodAndPointsThatAreNotFinite) {
  const auto classifier = make_nanoflann_pca_classifier();
  EXPECT_TRUE(classifier->classify({}, 1).labels.empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {nan, 0, 0}, {0, 1, 0}};
  const Classification result = classifier->classify(points, 1);
  EXPECT_EQ(result.labels, (std::vector{Label::h, Label::h, Label::unknown, Label::h}));
}

}  // namespace
}  // namespace planescope::planes
