// The quick network against the plain one, and what its answer must not depend on.

#include "core/classify/gcn.hpp"

#include <gtest/gtest.h>

#include "core/baselines/plain_gcn.hpp"
#include "core/classify/neighbour_grid.hpp"
#include "core/classify/random_weights.hpp"
#include "core/synthetic/random.hpp"
#include "core/synthetic/stairs.hpp"

namespace planescope {
namespace {

std::vector<Vec3f> stairs_points(int count, double noise_m = 0.002) {
  StairsOptions options;
  options.points = count;
  options.noise_m = noise_m;
  return make_stairs(0, options).cloud.points;
}

/// An odd one: widths that fill no register, two supports, a level of one convolution, few points.
NetworkConfig odd_config() {
  NetworkConfig config;
  config.name = "odd";
  config.levels = {{20, 7}, {33}, {18, 5}};
  config.supports = 2;
  config.neighbours = 9;
  config.pool_rate = 3;
  config.pool_neighbours = 5;
  config.global_feature = true;
  config.head = {19, 10};
  return config;
}

std::vector<float> plain_logits(const NetworkWeights& weights, const std::vector<Vec3f>& points) {
  const NeighbourGrid grid(points, weights.config.neighbours + 1);
  const std::vector<Vec3f> sorted(grid.points().begin(), grid.points().end());
  PlainNetwork<double> network{weights.config, {}};
  for (const auto& tensor : weights.tensors)
    network.tensors.emplace_back(tensor.begin(), tensor.end());
  const auto logits = plain_forward(network, make_plain_graph(sorted, weights.config), sorted);
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

TEST(Gcn, AgreesWithThePlainOne) {
  const std::vector<Vec3f> points = stairs_points(700);
  for (const NetworkConfig& config : {network_config("compact"), network_config("small"),
                                      network_config("official"), odd_config()}) {
    SCOPED_TRACE(config.name);
    const NetworkWeights weights = random_weights(config, 7);
    const std::vector<float> logits = Gcn(weights).forward(points, 2);
    expect_near(logits, plain_logits(weights, points), 1e-5f);
    EXPECT_GT(*std::max_element(logits.begin(), logits.end()) -
                  *std::min_element(logits.begin(), logits.end()),
              1e-3f);
  }
}

}  // namespace
}  // namespace planescope
