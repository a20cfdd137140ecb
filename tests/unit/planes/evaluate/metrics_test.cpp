// Tests of segmentation metrics, plane assignment and label accuracy.

#include "core/planes/evaluate/metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/lab/synthetic/stairs.hpp"
#include "core/model/random.hpp"

namespace planescope::planes {
namespace {

/// Two true planes of 100 points each (z = 0 and z = 1) on a 10 x 10 grid of 10 cm.
struct Scene {
  std::vector<Vec3f> points;
  std::vector<std::int32_t> truth;
  std::vector<std::int32_t> found;
  std::vector<Vec3d> normals;
};

Scene scene() {
  Scene s;
  for (int plane = 0; plane < 2; ++plane)
    for (int i = 0; i < 100; ++i) {
      s.points.push_back(Vec3f(0.1f * static_cast<float>(i % 10), 0.1f * static_cast<float>(i / 10),
                               static_cast<float>(plane)));
      s.truth.push_back(plane + 1);
    }
  s.found = s.truth;
  s.normals.assign(4, Vec3d::UnitZ());
  return s;
}

Metrics score(const Scene& s) {
  return evaluate({s.points, s.truth, s.found, s.normals, {}, {}, {}});
}

TEST(Metrics, APerfectResultScoresPerfectly) {
  const Metrics m = score(scene());
  EXPECT_EQ(m.planes_truth, 2);
  EXPECT_EQ(m.planes_found, 2);
  EXPECT_EQ(m.r_p, 100);
  EXPECT_EQ(m.r_m, 0);
  EXPECT_EQ(m.point_accuracy, 100);
  EXPECT_EQ(m.mean_iou, 100);
  EXPECT_EQ(m.detected_iou80, 2);
  EXPECT_EQ(m.over_segmented + m.under_segmented + m.missed + m.noise, 0);
  EXPECT_NEAR(m.alpha_deg, 0, 1e-6);
}

TEST(Metrics, IdsMayBeNumberedDifferently) {
  Scene s = scene();
  for (auto& f : s.found) f = f == 1 ? 4 : 3;
  EXPECT_EQ(score(s).point_accuracy, 100);
  EXPECT_EQ(score(s).planes_found, 2);
}

TEST(Metrics, MissingPointsAreCountedAmongPointsOfTruePlanes) {
  Scene s = scene();
  std::fill(s.found.begin(), s.found.begin() + 10, 0);
  EXPECT_DOUBLE_EQ(score(s).r_m, 5);
  EXPECT_DOUBLE_EQ(score(s).point_accuracy, 95);
  s.truth[0] = -1;  // not scored
  EXPECT_EQ(score(s).points, 199u);
}

TEST(Metrics, ASplitPlaneIsOverSegmented) {
  Scene s = scene();
  for (int i = 0; i < 50; ++i) s.found[i] = 3;
  const Metrics m = score(s);
  EXPECT_EQ(m.r_p, 150);
  EXPECT_EQ(m.over_segmented, 1);
  EXPECT_EQ(m.missed + m.noise + m.under_segmented, 0);
  EXPECT_DOUBLE_EQ(m.point_accuracy, 75);
  EXPECT_DOUBLE_EQ(m.mean_iou, 75);
}

TEST(Metrics, MergedPlanesAreUnderSegmented) {
  Scene s = scene();
  std::fill(s.found.begin(), s.found.end(), 1);
  const Metrics m = score(s);
  EXPECT_EQ(m.r_p, 50);
  EXPECT_EQ(m.under_segmented, 1);
  EXPECT_EQ(m.missed + m.noise, 0);
  EXPECT_DOUBLE_EQ(m.point_accuracy, 50);
}

TEST(Metrics, AnUnfoundPlaneIsMissedAndAFalseOneIsNoise) {
  Scene s = scene();
  std::fill(s.found.begin(), s.found.begin() + 100, 0);
  EXPECT_EQ(score(s).missed, 1);
  s = scene();
  for (int i = 0; i < 10; ++i) s.found[i] = 3;  // a tenth of a plane
  EXPECT_EQ(score(s).noise, 1);
  EXPECT_EQ(score(s).missed, 0);
}

TEST(Metrics, APlaneIsCorrectIfItSharesFourFifthsOfBoth) {
  Scene s = scene();
  EXPECT_EQ(score(s).correct, 2);
  for (int i = 0; i < 20; ++i) s.found[i] = 0;
  EXPECT_EQ(score(s).correct, 2);
  s.found[20] = 0;
  s.found[0] = s.found[1] = 3;
  EXPECT_EQ(score(s).correct, 1);
  EXPECT_NEAR(plane_precision(score(s)), 100.0 / 3, 1e-9);
  EXPECT_EQ(plane_recall(score(s)), 50);
  EXPECT_EQ(plane_precision({}) + plane_recall({}), 0);
}

TEST(Metrics, UnmatchedPlanesArePiecesOrGhosts) {
  Scene s = scene();
  EXPECT_EQ(score(s).pieces + score(s).ghosts, 0);
  for (int i = 0; i < 30; ++i) s.found[i] = 3;  // part of plane 1, whose IoU is still 0.7
  EXPECT_EQ(score(s).pieces, 1);
  EXPECT_EQ(score(s).ghosts, 0);
  for (int i = 0; i < 14; ++i) s.truth[i] = 0;  // 16 of 30 are on plane 1
  EXPECT_EQ(score(s).pieces, 1);
  for (int i = 14; i < 16; ++i) s.truth[i] = 0;  // 14 of 30
  EXPECT_EQ(score(s).pieces, 0);
  EXPECT_EQ(score(s).ghosts, 1);
}

TEST(Metrics, TheLargestPieceOfASplitPlaneMatchesIt) {
  Scene s = scene();
  for (int i = 0; i < 50; ++i) s.found[i] = 3;  // halves: an IoU of 0.5 is not a match
  EXPECT_EQ(score(s).pieces, 2);
  s.found[0] = 1;
  EXPECT_EQ(score(s).pieces, 1);
}

TEST(Metrics, PanopticQualityPenalizesEveryPlaneWithoutAPartner) {
  Scene s = scene();
  EXPECT_EQ(score(s).pq, 100);
  for (int i = 0; i < 20; ++i) s.found[i] = 0;  // IoU 0.8 and 1
  EXPECT_NEAR(score(s).pq, 90, 1e-9);
  for (int i = 100; i < 160; ++i) s.found[i] = 3;  // IoU 0.8 and 0.4, for 2 true and 3 found planes
  s.found[100] = 4;                                // 4 found
  EXPECT_NEAR(score(s).pq, 100 * (0.8 + 59.0 / 100) / 3, 1e-9);
}

TEST(Metrics, TruePlanesBelowTheMinimumAreNeitherFoundNorMissed) {
  Scene s = scene();
  for (int i = 0; i < 10; ++i) {
    s.truth[i] = 3;
    s.found[i] = 3;
  }
  const auto scored = [&](int least) {
    return evaluate({.points = s.points,
                     .truth = s.truth,
                     .found = s.found,
                     .found_normals = s.normals,
                     .truth_normals = {},
                     .truth_labels = {},
                     .found_labels = {},
                     .min_truth_points = least});
  };
  EXPECT_EQ(scored(10).planes_truth, 3);
  EXPECT_EQ(scored(11).planes_truth, 2);
  EXPECT_EQ(scored(11).planes_found, 2);  // the third one is on unscored points
  EXPECT_EQ(scored(11).noise, 0);
  EXPECT_EQ(scored(11).points, 190u);
  EXPECT_EQ(scored(11).mean_iou, 100);
}

TEST(Metrics, APlaneMostlyOnUnscoredPointsIsIgnored) {
  Scene s = scene();
  for (int i = 0; i < 30; ++i) s.found[i] = 3;
  for (int i = 0; i < 20; ++i) s.truth[i] = -1;
  EXPECT_EQ(score(s).planes_found, 2);
  EXPECT_NEAR(score(s).r_m, 100.0 * 10 / 180, 1e-9);  // its points of plane 1 are missing
  s.truth[0] = s.truth[1] = s.truth[2] = s.truth[3] = s.truth[4] = 1;
  EXPECT_EQ(score(s).planes_found, 3);
}

TEST(Metrics, AlphaIsTheMeanAngleToTheMajorityPlane) {
  Scene s = scene();
  s.normals[1] = Vec3d(std::sin(0.1), 0, -std::cos(0.1));  // signs do not matter
  EXPECT_NEAR(score(s).alpha_deg, 0.05 * 180 / M_PI, 1e-6);
}

TEST(Metrics, LabelAccuracyDistinguishesEdges) {
  std::vector<Vec3f> points;
  std::vector<Label> truth, found;
  for (int i = 0; i < 10; ++i) {  // a row with 1 cm spacing; the label changes in the middle
    points.push_back({0.01f * static_cast<float>(i), 0, 0});
    truth.push_back(i < 5 ? Label::h : Label::v);
    found.push_back(i < 4 ? Label::h : Label::v);  // point 4, at the edge, is wrong
  }
  const std::vector<std::int32_t> ids(10, 1);
  const std::vector<Vec3d> normals{Vec3d::UnitZ()};
  const Metrics m = evaluate({points, ids, ids, normals, normals, truth, found});
  EXPECT_DOUBLE_EQ(m.label_accuracy_inner, 100);
  EXPECT_LT(m.label_accuracy_edge, 100);
}

TEST(Metrics, TheMeanUsesRatiosOfSumsForPlanes) {
  Metrics a, b;
  a.planes_truth = 2, a.planes_found = 4, a.r_p = 200, a.alpha_deg = 1;
  b.planes_truth = 8, b.planes_found = 8, b.r_p = 100, b.alpha_deg = 3;
  const std::vector<Metrics> both{a, b};
  EXPECT_DOUBLE_EQ(mean_of(both).r_p, 120);
  EXPECT_DOUBLE_EQ(mean_of(both).alpha_deg, 2);
}

TEST(Metrics, TheMeanAddsUpEveryCount) {
  Metrics one;
  visit_values(one, [](const char*, auto& value) {
    if constexpr (std::is_integral_v<std::remove_reference_t<decltype(value)>>) value = 1;
  });
  const Metrics sum = mean_of(std::vector<Metrics>{one, one});
  visit_values(sum, [](const char* name, const auto& value) {
    if constexpr (std::is_integral_v<std::remove_cvref_t<decltype(value)>>) {
      EXPECT_EQ(value, 2u) << name;
    }
  });
}

TEST(Assignment, FindsTheBestOfAllPermutations) {
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    const int rows = random.integer(1, 5), columns = random.integer(1, 5);
    std::vector<double> value(static_cast<std::size_t>(rows) * columns);
    for (double& v : value) v = random.uniform() < 0.3 ? 0 : random.uniform();
    const std::vector<int> match = best_assignment(value, rows, columns);
    double total = 0;
    for (int r = 0; r < rows; ++r)
      if (match[r] >= 0) total += value[static_cast<std::size_t>(r) * columns + match[r]];
    std::vector<int> order(std::max(rows, columns));
    std::iota(order.begin(), order.end(), 0);
    double best = 0;
    do {
      double sum = 0;
      for (int r = 0; r < rows; ++r)
        if (order[r] < columns) sum += value[static_cast<std::size_t>(r) * columns + order[r]];
      best = std::max(best, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(total, best, 1e-12);
  }
}

TEST(LabelAccuracy, CountsPointsNearAnotherLabelSeparately) {
  // A line with 1 cm spacing: three h, two v, one of unknown truth.
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

TEST(LabelAccuracy, WithoutPointsIsPerfect) {
  EXPECT_EQ(label_accuracy({}, {}, {}).edge_percent(), 100);
  EXPECT_EQ(label_accuracy({}, {}, {}).inner_percent(), 100);
}

TEST(LabelAccuracy, DetectsEdgesOfAStaircaseEvenIfPointsAreSparse) {
  // Points 10 cm apart: almost none has a point with another label within 2 cm, although there are
  // many edges.
  const LabeledCloud stairs = lab::labeled(lab::make_stairs(0, {.points = 300}));
  const auto near_points =
      near_other_label(stairs.points, stairs.labels, stairs.points, stairs.labels);
  const auto edges = std::count(stairs.near_edge.begin(), stairs.near_edge.end(), 1);
  EXPECT_GT(edges, 2 * std::count(near_points.begin(), near_points.end(), 1));
  for (std::size_t i = 0; i < near_points.size(); ++i)
    EXPECT_LE(near_points[i], stairs.near_edge[i]) << "point " << i;
}

}  // namespace
}  // namespace planescope::planes
