// Search for the k = 16 nearest neighbors of every point of a staircase, including building the
// index, compared with nanoflann's k-d tree; and the PCA classifier, which uses our search. One
// thread. Each round runs all of them; counters give medians, and the ratio of nanoflann's time to
// ours.

#include <benchmark/benchmark.h>

#include <nanoflann.hpp>
#include <string>

#include "core/lab/bench/measuring.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/classify/neighbour_grid.hpp"

namespace planescope {
namespace {

constexpr int kNeighbors = 16;

std::vector<Vec3f> staircase(int points) {
  lab::StairsOptions options;
  options.points = points;
  options.noise_m = 0.002;
  return lab::make_stairs(0, options).cloud.points;
}

std::vector<std::uint32_t> by_grid(std::span<const Vec3f> points) {
  const planes::NeighborGrid grid(points, kNeighbors);
  std::vector<std::uint32_t> rows(points.size() * kNeighbors);
  grid.nearest(kNeighbors, 0, points.size(), rows.data());
  return rows;
}

struct Adaptor {
  std::span<const Vec3f> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

std::vector<std::uint32_t> by_nanoflann(std::span<const Vec3f> points) {
  using Distance = nanoflann::L2_Simple_Adaptor<float, Adaptor, float, std::uint32_t>;
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<Distance, Adaptor, 3, std::uint32_t>;
  const Adaptor adaptor{points};
  Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  std::vector<std::uint32_t> rows(points.size() * kNeighbors);
  std::vector<float> squared(kNeighbors);
  for (std::size_t i = 0; i < points.size(); ++i)
    tree.knnSearch(points[i].data(), kNeighbors, rows.data() + i * kNeighbors, squared.data());
  return rows;
}

void neighbors(benchmark::State& state) {
  const std::vector<Vec3f> points = staircase(static_cast<int>(state.range(0)));
  const auto pca = planes::make_pca_classifier({.neighbors = kNeighbors});
  std::vector<double> grid_ms, nanoflann_ms, pca_ms;
  for (auto _ : state) {
    grid_ms.push_back(lab::thread_ms([&] { benchmark::DoNotOptimize(by_grid(points)); }));
    nanoflann_ms.push_back(lab::thread_ms([&] { benchmark::DoNotOptimize(by_nanoflann(points)); }));
    pca_ms.push_back(lab::thread_ms([&] { benchmark::DoNotOptimize(pca->classify(points, 1)); }));
  }
  state.counters["nanoflann_ms"] = lab::median(nanoflann_ms);
  state.counters["grid_ms"] = lab::median(grid_ms);
  state.counters["grid_ratio"] = lab::median(nanoflann_ms) / lab::median(grid_ms);
  state.counters["pca_ms"] = lab::median(pca_ms);
}
BENCHMARK(neighbors)->RangeMultiplier(2)->Range(2048, 16384)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace planescope

BENCHMARK_MAIN();
