#include "core/lab/bench/speed_bench.hpp"

#include <memory>

#include "core/lab/bench/measuring.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/planes/classify/gcn.hpp"
#include "core/planes/classify/gcn_forward.hpp"
#include "core/planes/classify/neighbour_grid.hpp"
#include "core/planes/rivals/rival_classifiers.hpp"

namespace planescope::lab {
namespace {

using Points = std::vector<Vec3f>;

constexpr int kSizes[] = {2048, 4096, 8192};
constexpr int kStairs = 3;  // taken in turn

/// The instruction sets of this machine, the widest last.
std::vector<Simd> instruction_sets() {
  std::vector<Simd> sets;
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512})
    if (simd <= best_simd()) sets.push_back(simd);
  return sets;
}

std::vector<Points> make_clouds(int points, std::uint64_t seed) {
  std::vector<Points> clouds;
  for (int i = 0; i < kStairs; ++i)
    clouds.push_back(
        make_stairs(i, {.seed = seed, .points = points, .noise_m = 0.001}).cloud.points);
  return clouds;
}

/// Counts turns over all contests.
class Turns {
 public:
  Turns(int all, const std::function<void(int, int)>& progress) : all_(all), progress_(progress) {}
  void next() {
    if (progress_) progress_(done_++, all_);
  }

 private:
  int done_ = 0, all_;
  const std::function<void(int, int)>& progress_;
};

SpeedRow race(const BenchNetwork& network,
              const std::vector<Points>& clouds,
              int rounds,
              int threads,
              Turns& turns) {
  std::vector<std::unique_ptr<planes::Classifier>> classifiers;
  const std::vector<Simd> sets = instruction_sets();
  for (const Simd simd : sets)
    classifiers.push_back(planes::make_gcn_classifier(network.weights, network.name, simd));
  const planes::PcaClassifierOptions pca{.neighbours = 16};
  classifiers.push_back(planes::make_nanoflann_pca_classifier(pca));
  classifiers.push_back(planes::make_pca_classifier(pca));

  const auto ms = interleaved_ms(
      classifiers.size(), rounds, [&] { turns.next(); },
      [&](std::size_t who, int round) {
        classifiers[who]->classify(clouds[static_cast<std::size_t>(round % kStairs)], threads);
      });
  SpeedRow row{network.name, static_cast<int>(clouds[0].size()), threads, {}};
  for (std::size_t s = 0; s < sets.size(); ++s) row.network_ms.emplace_back(sets[s], median(ms[s]));
  const auto &best = ms[sets.size() - 1], &nanoflann = ms[sets.size()], &ours = ms[sets.size() + 1];
  row.nanoflann_ms = median(nanoflann);
  row.pca_ms = median(ours);
  row.nanoflann_ratio = median_ratio(nanoflann, best);
  row.pca_ratio = median_ratio(ours, best);
  return row;
}

ReferenceRow race_reference(const BenchNetwork& network,
                            const Points& cloud,
                            int rounds,
                            Turns& turns) {
  const planes::NetworkConfig& config = network.weights.config;
  const Simd simd = best_simd();
  const planes::NeighbourGrid grid(cloud, config.neighbours + 1);
  const std::span<const Vec3f> points = grid.points();  // the order in which pooling counts
  const planes::PlainGraph plain_graph = planes::make_plain_graph(points, config);
  const planes::PlainNetwork<float> plain{config, network.weights.tensors};
  planes::gcn::Graph graph;
  planes::gcn::make_graph(points, config, 1, simd, graph);
  const planes::gcn::Layers layers = planes::gcn::make_layers(network.weights);
  planes::gcn::Activations activations;
  const planes::Gcn whole(network.weights, simd);

  enum { kWhole, kForward, kPlain, kCount };
  const auto ms = interleaved_ms(
      kCount, rounds, [&] { turns.next(); },
      [&](std::size_t who, int) {
        if (who == kWhole) whole.forward(points, 1);
        if (who == kForward)
          planes::gcn::forward(graph, layers, planes::gcn::kernels(simd), 1, false, activations);
        if (who == kPlain) planes::plain_forward(plain, plain_graph, points);
      });
  return {network.name,
          static_cast<int>(points.size()),
          median(ms[kWhole]),
          median(ms[kForward]),
          median(ms[kPlain]),
          median_ratio(ms[kPlain], ms[kWhole]),
          median_ratio(ms[kPlain], ms[kForward])};
}

}  // namespace

SpeedBench measure_speed(std::span<const BenchNetwork> networks,
                         const SpeedBenchOptions& options,
                         const std::function<void(int, int)>& progress) {
  std::vector<int> thread_counts = {1};
  if (options.threads > 1) thread_counts.push_back(options.threads);
  const std::size_t per_round =
      networks.size() * thread_counts.size() * (instruction_sets().size() + 2) + 3;
  Turns turns(static_cast<int>(std::size(kSizes) * per_round) * (options.rounds + 1), progress);

  SpeedBench bench;
  for (const int points : kSizes) {
    const std::vector<Points> clouds = make_clouds(points, options.seed);
    for (const BenchNetwork& network : networks)
      for (const int threads : thread_counts)
        bench.speed.push_back(race(network, clouds, options.rounds, threads, turns));
    bench.reference.push_back(race_reference(networks[0], clouds[0], options.rounds, turns));
  }
  return bench;
}

}  // namespace planescope::lab
