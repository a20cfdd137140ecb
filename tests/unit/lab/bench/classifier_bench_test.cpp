// Tests of the classifier benchmark, and of the shipped network's accuracy.

#include "core/lab/bench/classifier_bench.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace planescope::lab {
namespace {

std::vector<NamedClassifier> pca() { return {{"pca", planes::make_pca_classifier()}}; }

TEST(LabelBench, TiltedCloudsAreTiltedByExactlyTheAngle) {
  const planes::LabeledCloud up{"stairs", {{0, 0, 1}}, {Label::h}};
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const planes::LabeledCloud off = tilted(up, 5, seed);
    EXPECT_NEAR(off.points[0].z(), std::cos(5 * std::numbers::pi / 180), 1e-6);
    EXPECT_EQ(off.labels, up.labels);
  }
  EXPECT_NE(tilted(up, 5, 1).points, tilted(up, 5, 2).points);
}

TEST(LabelBench, IsTheSameForAnyThreadCount) {
  const auto one = measure_labels(pca(), {.count = 2, .tilt_deg = 5, .threads = 1});
  const auto three = measure_labels(pca(), {.count = 2, .tilt_deg = 5, .threads = 3});
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].set, three[i].set);
    EXPECT_EQ(one[i].level.edge_right, three[i].level.edge_right);
    EXPECT_EQ(one[i].tilted.inner_right, three[i].tilted.inner_right);
    EXPECT_GT(one[i].level.edge, 0u) << one[i].set;
    EXPECT_EQ(one[i].level.edge, one[i].tilted.edge) << one[i].set;
  }
}

TEST(LabelBench, NoiseReducesTheAccuracyOfEdgeLabels) {
  const auto rows = measure_labels(pca(), {.count = 4});
  EXPECT_EQ(rows[0].set, "stairs, 0 cm");
  EXPECT_EQ(rows[3].set, "stairs, 0.3 cm");
  EXPECT_GT(rows[0].level.edge_percent(), rows[3].level.edge_percent());
  EXPECT_EQ(rows[0].tilted.edge, 0u);  // not measured
}

TEST(LabelBench, TheShippedNetworkKeepsItsAccuracyAndBeatsNormalsNearEdges) {
  const NamedClassifier gcn = {
      "gcn", planes::make_classifier({}, PLANESCOPE_SOURCE_DIR "/assets/classifier.safetensors")
                 .classifier};
  // Half a percentage point below the result for these clouds; docs/classifier.md has results for
  // 100 of each.
  const std::map<std::string, double> least_edge = {{"stairs, 0 cm", 97.1},
                                                    {"stairs, 0.1 cm", 95.0},
                                                    {"stairs, 0.2 cm", 92.4},
                                                    {"stairs, 0.3 cm", 89.4},
                                                    {"scans of composed scenes", 89.5},
                                                    {"scans of named scenes", 91.1}};
  const auto rows = measure_labels(std::vector{gcn, pca()[0]}, {.count = 6});
  ASSERT_EQ(rows.size(), 2 * least_edge.size());
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    ASSERT_EQ(rows[i].classifier, "gcn");
    EXPECT_GE(rows[i].level.edge_percent(), least_edge.at(rows[i].set)) << rows[i].set;
    EXPECT_GE(rows[i].level.inner_percent(), 99.9) << rows[i].set;
    EXPECT_GT(rows[i].level.edge_percent(), rows[i + 1].level.edge_percent()) << rows[i].set;
  }
}

TEST(LabelBench, StopsIfProgressThrows) {
  int calls = 0;
  const auto stop = [&](int, int) {
    if (++calls == 2) throw std::runtime_error("stop");
  };
  EXPECT_THROW(measure_labels(pca(), {.count = 50}, stop), std::runtime_error);
  EXPECT_EQ(calls, 2);
}

TEST(ChainBench, TrueLabelsFindEveryPlane) {
  const auto rows =
      measure_chain(pca(), planes::profile_options(planes::Profile::refined), {.count = 3});
  ASSERT_EQ(rows.size(), 8u);  // noises x (truth, pca)
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    EXPECT_EQ(rows[i].labels, "truth");
    EXPECT_EQ(rows[i].metrics.r_p, 100);
    EXPECT_GT(rows[i].metrics.point_accuracy, 99.5);
    EXPECT_EQ(rows[i + 1].labels, "pca");
    EXPECT_LE(rows[i + 1].metrics.point_accuracy, rows[i].metrics.point_accuracy);
  }
}

}  // namespace
}  // namespace planescope::lab
