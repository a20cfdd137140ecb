// The fast network compared with a plain implementation, and invariances of its result.

#include "core/planes/classify/gcn.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/lab/rivals/rivals.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/lab/training/train.hpp"
#include "core/model/parallel.hpp"
#include "core/model/random.hpp"
#include "core/planes/classify/neighbour_grid.hpp"

namespace planescope::planes {
namespace {

std::vector<Vec3f> stairs_points(int count, double noise_m = 0.002) {
  lab::StairsOptions options;
  options.points = count;
  options.noise_m = noise_m;
  return lab::make_stairs(0, options).cloud.points;
}

/// An unusual configuration: widths that do not fill a register, two supports, a level with one
/// convolution, few points.
NetworkConfig odd_config() {
  NetworkConfig config;
  config.name = "odd";
  config.levels = {{20, 7}, {33}, {18, 5}};
  config.supports = 2;
  config.neighbors = 9;
  config.pool_rate = 3;
  config.pool_neighbors = 5;
  config.global_feature = true;
  config.head = {19, 10};
  return config;
}

std::vector<float> plain_logits(const NetworkWeights& weights, const std::vector<Vec3f>& points) {
  const NeighborGrid grid(points, weights.config.neighbors + 1);
  const std::vector<Vec3f> sorted(grid.points().begin(), grid.points().end());
  lab::PlainNetwork<double> network{weights.config, {}};
  for (const auto& tensor : weights.tensors)
    network.tensors.emplace_back(tensor.begin(), tensor.end());
  const auto logits =
      lab::plain_forward(network, lab::make_plain_graph(sorted, weights.config), sorted);
  std::vector<float> result(2 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t c = 0; c < 2; ++c)
      result[2 * grid.order()[i] + c] = static_cast<float>(logits[i][c]);
  return result;
}

void expect_near(const std::vector<float>& a, const std::vector<float>& b, float tolerance) {
  ASSERT_EQ(a.size(), b.size());
  float largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  EXPECT_LE(largest, tolerance);
}

TEST(Gcn, AgreesWithThePlainImplementation) {
  const std::vector<Vec3f> points = stairs_points(700);
  for (const NetworkConfig& config : {network_config("compact"), network_config("small"),
                                      network_config("official"), odd_config()}) {
    SCOPED_TRACE(config.name);
    const NetworkWeights weights = lab::random_weights(config, 7);
    const std::vector<float> logits = Gcn(weights).forward(points, 2);
    expect_near(logits, plain_logits(weights, points), 1e-5f);
    EXPECT_GT(*std::max_element(logits.begin(), logits.end()) -
                  *std::min_element(logits.begin(), logits.end()),
              1e-3f);
  }
}

std::vector<std::size_t> shuffled_order(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed);
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[random.integer(0, static_cast<int>(i) - 1)]);
  return order;
}

/// Share of points with the same label in two results.
double agreement(const std::vector<float>& a, const std::vector<float>& b) {
  std::size_t alike = 0;
  for (std::size_t i = 0; i < a.size(); i += 2) alike += (a[i] < a[i + 1]) == (b[i] < b[i + 1]);
  return 2 * static_cast<double>(alike) / static_cast<double>(a.size());
}

/// Weights with mixed results: the bias of the last layer makes half of the points h.
NetworkWeights undecided_weights(const NetworkConfig& config, const std::vector<Vec3f>& points) {
  NetworkWeights weights = lab::random_weights(config, 7);
  const std::vector<float> logits = Gcn(weights).forward(points, 1);
  std::vector<float> leads;
  for (std::size_t i = 0; i < logits.size(); i += 2) leads.push_back(logits[i] - logits[i + 1]);
  std::nth_element(leads.begin(), leads.begin() + leads.size() / 2, leads.end());
  weights.tensors.back()[0] -= leads[leads.size() / 2];
  return weights;
}

TEST(Gcn, GivesIdenticalResultsForEveryInstructionSetAndThreadCount) {
  const std::vector<Vec3f> points = stairs_points(2000);
  for (const NetworkConfig& config : {network_config("compact"), odd_config()}) {
    const NetworkWeights weights = lab::random_weights(config, 3);
    const std::vector<float> expected = Gcn(weights, Simd::plain).forward(points, 1);
    for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512}) {
      if (simd > best_simd()) continue;
      for (const int threads : {1, 2, 5}) {
        SCOPED_TRACE(config.name + ", " + to_string(simd) + ", " + std::to_string(threads));
        EXPECT_EQ(Gcn(weights, simd).forward(points, threads), expected);
      }
    }
  }
}

TEST(Gcn, LabelsAPermutedCloudLikeTheOriginal) {
  const std::vector<Vec3f> points = stairs_points(3000);
  for (const NetworkConfig& config : {network_config("compact"), network_config("small")}) {
    const Gcn network(lab::random_weights(config, 4));
    const std::vector<float> logits = network.forward(points, 1);
    const std::vector<std::size_t> order = shuffled_order(points.size(), 9);
    std::vector<Vec3f> permuted;
    for (const std::size_t i : order) permuted.push_back(points[i]);
    const std::vector<float> of_permuted = network.forward(permuted, 1);
    for (std::size_t i = 0; i < order.size(); ++i) {
      ASSERT_EQ(of_permuted[2 * i], logits[2 * order[i]]);
      ASSERT_EQ(of_permuted[2 * i + 1], logits[2 * order[i] + 1]);
    }
  }
}

TEST(Gcn, LabelsAPermutedGridWithEqualDistancesAndEqualPointsAlike) {
  std::vector<Vec3f> points;
  for (int x = 0; x < 24; ++x)
    for (int y = 0; y < 24; ++y) {
      points.emplace_back(0.02f * static_cast<float>(x), 0.02f * static_cast<float>(y), 0);
      points.emplace_back(0, 0.02f * static_cast<float>(x), 0.02f * static_cast<float>(y));
    }
  for (int i = 0; i < 40; ++i) points.push_back(points[3]);
  const Gcn network(lab::random_weights(network_config("small"), 4));
  const std::vector<float> logits = network.forward(points, 1);
  const std::vector<std::size_t> order = shuffled_order(points.size(), 5);
  std::vector<Vec3f> permuted;
  for (const std::size_t i : order) permuted.push_back(points[i]);
  const std::vector<float> of_permuted = network.forward(permuted, 2);
  for (std::size_t i = 0; i < order.size(); ++i)
    ASSERT_EQ(of_permuted[2 * i], logits[2 * order[i]]) << "point " << order[i];
}

TEST(Gcn, DoesNotDependOnEarlierClouds) {
  const NetworkWeights weights = lab::random_weights(network_config("small"), 4);
  const Gcn network(weights);
  for (const int count : {3000, 40, 1, 900, 3000}) {
    const std::vector<Vec3f> points = stairs_points(count);
    EXPECT_EQ(network.forward(points, 1), Gcn(weights).forward(points, 1)) << count << " points";
  }
}

TEST(Gcn, IsThreadSafe) {
  const Gcn network(lab::random_weights(network_config("compact"), 4));
  const std::vector<Vec3f> a = stairs_points(1500), b = stairs_points(700, 0);
  const std::vector<float> of_a = network.forward(a, 1), of_b = network.forward(b, 1);
  parallel_for(
      4, 4,
      [&](std::size_t begin, std::size_t) {
        for (int i = 0; i < 5; ++i)
          EXPECT_EQ(network.forward(begin % 2 == 0 ? a : b, 2), begin % 2 == 0 ? of_a : of_b);
      },
      1);
}

TEST(Gcn, LabelsACloudFarFromTheOriginAlike) {
  const std::vector<Vec3f> points = stairs_points(8192);
  const NetworkWeights weights = undecided_weights(network_config("compact"), points);
  const auto classifier = make_gcn_classifier(weights);
  std::vector<Vec3d> far;
  for (const Vec3f& p : points) far.push_back(p.cast<double>() + Vec3d(600, -700, 400));
  const Classification here = classifier->classify(points, 2);
  const Classification there = classify_about_origin(*classifier, far, 2);
  std::size_t alike = 0, h = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    alike += here.labels[i] == there.labels[i];
    h += here.labels[i] == Label::h;
  }
  EXPECT_NEAR(static_cast<double>(h), 4096, 100);
  EXPECT_GE(static_cast<double>(alike), 0.999 * 8192);
}

TEST(Gcn, IsIndependentOfScale) {
  const std::vector<Vec3f> points = stairs_points(4000);
  const Gcn network(undecided_weights(network_config("compact"), points));
  const std::vector<float> logits = network.forward(points, 1);
  const auto scaled = [&](float factor) {
    std::vector<Vec3f> result;
    for (const Vec3f& p : points) result.push_back(factor * p);
    return network.forward(result, 1);
  };
  EXPECT_EQ(scaled(1.0f / 1024), logits);  // exact in floats: identical
  EXPECT_EQ(scaled(64), logits);
  EXPECT_GE(agreement(scaled(3.7f), logits), 0.999);
}

TEST(Gcn, WorksForVeryFewPoints) {
  for (const NetworkConfig& config : {network_config("compact"), network_config("official")}) {
    const auto classifier = make_gcn_classifier(lab::random_weights(config, 2));
    for (const std::size_t count : {0, 1, 2, 3, 5, 16, 17, 40}) {
      std::vector<Vec3f> points;
      for (std::size_t i = 0; i < count; ++i)
        points.emplace_back(0.02f * static_cast<float>(i), 0.01f * static_cast<float>(i % 3), 0);
      const Classification result = classifier->classify(points, 2);
      ASSERT_EQ(result.labels.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_NE(result.labels[i], Label::unknown);
        EXPECT_TRUE(result.margins[i] >= 0 && result.margins[i] <= 1);
      }
    }
  }
}

TEST(Gcn, LabelsEqualPointsAlike) {
  const auto classifier = make_gcn_classifier(lab::random_weights(network_config("compact"), 2));
  const std::vector<Vec3f> same(500, Vec3f(1, 2, 3));
  const Classification result = classifier->classify(same, 2);
  for (std::size_t i = 0; i < same.size(); ++i) {
    EXPECT_EQ(result.labels[i], result.labels[0]);
    EXPECT_EQ(result.margins[i], result.margins[0]);
  }
}

TEST(Gcn, LabelsNonFinitePointsUnknownWithoutAffectingOthers) {
  const auto classifier = make_gcn_classifier(lab::random_weights(network_config("compact"), 2));
  const std::vector<Vec3f> points = stairs_points(600);
  std::vector<Vec3f> with_gaps = points;
  with_gaps.insert(with_gaps.begin() + 100, Vec3f(0, NAN, 0));
  with_gaps.push_back(Vec3f(INFINITY, 0, 0));
  const Classification expected = classifier->classify(points, 1);
  Classification result = classifier->classify(with_gaps, 1);
  EXPECT_EQ(result.labels[100], Label::unknown);
  EXPECT_EQ(result.margins[100], 0);
  EXPECT_EQ(result.labels.back(), Label::unknown);
  result.labels.pop_back();
  result.margins.pop_back();
  result.labels.erase(result.labels.begin() + 100);
  result.margins.erase(result.margins.begin() + 100);
  EXPECT_EQ(result.labels, expected.labels);
  EXPECT_EQ(result.margins, expected.margins);
  const std::vector<Vec3f> none(4, Vec3f(NAN, NAN, NAN));
  EXPECT_EQ(classifier->classify(none, 1).labels, std::vector<Label>(4, Label::unknown));
}

}  // namespace
}  // namespace planescope::planes
