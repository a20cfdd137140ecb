#include "core/planes/evaluate/label_accuracy.hpp"

#include <gtest/gtest.h>

#include "core/lab/synthetic/stairs.hpp"

namespace planescope::planes {
namespace {

TEST(LabelAccuracy, CountsPointsNearAnotherLabelApart) {
  // On a line, 1 cm apart: three h, two v, one of unknown truth.
  std::vector<Vec3f> points;
  for (int i = 0; i < 6; ++i) points.emplace_back(0.011f * static_cast<float>(i), 0, 0);
  const std::vector<Label> truth = {Label::h, Label::h, Label::h,
                                    Label::v, Label::v, Label::unknown};
  const std::vector<Label> found = {Label::v, Label::h, Label::h, Label::h, Label::v, Label::h};
  const auto near = near_other_label(points, truth, points, truth);
  EXPECT_EQ(near, (std::vector<std::uint8_t>{0, 0, 1, 1, 0, 1}));
  const LabelAccuracy accuracy = label_accuracy(truth, found, near);
  EXPECT_EQ(accuracy.edge, 2u);
  EXPECT_EQ(accuracy.edge_right, 1u);
  EXPECT_EQ(accuracy.inner, 3u);
  EXPECT_EQ(accuracy.inner_right, 2u);
  EXPECT_DOUBLE_EQ(accuracy.edge_percent(), 50);
}

TEST(LabelAccuracy, OfNothingIsAllRight) {
  EXPECT_EQ(label_accuracy({}, {}, {}).edge_percent(), 100);
  EXPECT_EQ(label_accuracy({}, {}, {}).inner_percent(), 100);
}

TEST(LabelAccuracy, KnowsTheEdgesOfAStaircaseThoughPointsAreSparse) {
  // Points 10 cm apart: hardly any has one of another label within 2 cm, though many an edge is.
  const LabelledCloud stairs = lab::labelled(lab::make_stairs(0, {.points = 300}));
  const auto near_points =
      near_other_label(stairs.points, stairs.labels, stairs.points, stairs.labels);
  const auto edges = std::count(stairs.near_edge.begin(), stairs.near_edge.end(), 1);
  EXPECT_GT(edges, 2 * std::count(near_points.begin(), near_points.end(), 1));
  for (std::size_t i = 0; i < near_points.size(); ++i)
    EXPECT_LE(near_points[i], stairs.near_edge[i]) << "point " << i;
}

}  // namespace
}  // namespace planescope::planes
