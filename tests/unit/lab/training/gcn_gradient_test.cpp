// The backward pass against finite differences of the plain network, in double precision.

#include <gtest/gtest.h>

#include <cmath>

#include "core/lab/training/gcn_backward.hpp"
#include "core/lab/training/train.hpp"
#include "core/model/random.hpp"
#include "core/planes/rivals/plain_gcn.hpp"

namespace planescope::lab {
namespace {

/// A bent sheet with noise: no two distances alike.
std::vector<Vec3f> sheet(int count) {
  Random random(3);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    const double u = random.uniform(), v = random.uniform();
    points.emplace_back(u, v, u > 0.5 ? u - 0.5 + 0.02 * random.normal() : 0.02 * random.normal());
  }
  return points;
}

void expect_gradients(const planes::NetworkConfig& config, int points_count) {
  const std::vector<Vec3f> points = sheet(points_count);
  const planes::NetworkWeights weights = random_weights(config, 5);
  planes::gcn::Graph graph;
  planes::gcn::make_graph(points, config, 1, best_simd(), graph);
  std::vector<Vec3f> sorted;
  for (const std::uint32_t i : graph.order) sorted.push_back(points[i]);

  // The loss is a random linear function of the logits.
  Random random(11);
  const planes::gcn::Layers layers = planes::gcn::make_layers(weights);
  const auto width = static_cast<std::size_t>(layers.head.back().out);
  Buffer slopes(points.size() * width, 0);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t c = 0; c < 2; ++c)
      slopes[i * width + c] = static_cast<float>(random.uniform(-1, 1));

  const planes::gcn::Kernels& kernels = planes::gcn::kernels(best_simd());
  planes::gcn::Activations a;
  planes::gcn::forward(graph, layers, kernels, 1, /*keep_winners=*/true, a);
  const auto gradients =
      planes::gcn::tensor_gradients(weights, backward(graph, layers, a, kernels, slopes));

  planes::PlainNetwork<double> network{config, {}};
  for (const auto& tensor : weights.tensors)
    network.tensors.emplace_back(tensor.begin(), tensor.end());
  const planes::PlainGraph plain = planes::make_plain_graph(sorted, config);
  const auto loss = [&] {
    const auto logits = planes::plain_forward(network, plain, sorted);
    double sum = 0;
    for (std::size_t i = 0; i < logits.size(); ++i)
      for (std::size_t c = 0; c < 2; ++c) sum += logits[i][c] * double{slopes[i * width + c]};
    return sum;
  };

  const std::vector<planes::TensorSpec> specs = planes::tensor_specs(config);
  for (std::size_t t = 0; t < specs.size(); ++t) {
    SCOPED_TRACE(specs[t].name);
    double largest = 0;
    for (const float g : gradients[t]) largest = std::max(largest, std::abs(double{g}));
    EXPECT_GT(largest, 0) << "nothing reaches this tensor";
    for (int draw = 0; draw < 12; ++draw) {
      const int i = random.integer(0, static_cast<int>(network.tensors[t].size()) - 1);
      // Steps so small that next to no maximum and no ReLU changes its branch.
      constexpr double kStep = 1e-6;
      double& value = network.tensors[t][i];
      const double kept = value;
      value = kept + kStep;
      const double above = loss();
      value = kept - kStep;
      const double below = loss();
      value = kept;
      EXPECT_NEAR(gradients[t][i], (above - below) / (2 * kStep), 2e-3 * largest + 1e-6)
          << "entry " << i;
    }
  }
}

TEST(GcnGradient, OfCompactMatchesFiniteDifferences) {
  expect_gradients(planes::network_config("compact"), 300);
}

TEST(GcnGradient, OfEveryKindOfLayerMatchesFiniteDifferences) {
  planes::NetworkConfig config;
  config.levels = {{20, 7}, {17}, {18, 5}};
  config.supports = 2;
  config.neighbours = 6;
  config.pool_rate = 3;
  config.pool_neighbours = 4;
  config.global_feature = true;
  config.head = {19, 10};
  expect_gradients(config, 200);
}

TEST(GcnGradient, WithoutAHiddenLayerMatchesFiniteDifferences) {
  planes::NetworkConfig config;
  config.levels = {{8}};
  config.head = {};
  expect_gradients(config, 60);
}

}  // namespace
}  // namespace planescope::lab
