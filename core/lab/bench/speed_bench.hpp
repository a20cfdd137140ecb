#pragma once

// How quick classifiers are: networks on every instruction set against PCA normals, and against
// the same network written plainly.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/model/parallel.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::lab {

struct BenchNetwork {
  std::string name;  // in the tables
  planes::NetworkWeights weights;
};

struct SpeedBenchOptions {
  std::uint64_t seed = 960001;
  int rounds = 20;  // whose median counts
  int threads = 1;  // "all cores": measured with one and with these
};

/// One staircase after the other with 0.1 cm of noise, from points to labels and margins.
struct SpeedRow {
  std::string network;
  int points = 0, threads = 1;
  std::vector<std::pair<Simd, double>> network_ms;  // the widest instruction set last
  double nanoflann_ms = 0, pca_ms = 0;              // PCA with 16 neighbours, nanoflann's and ours
  double nanoflann_ratio = 0, pca_ratio = 0;        // as multiples of the network's time
};

/// On one thread. The plain forward is given its neighbours: nothing of it is a search.
struct ReferenceRow {
  std::string network;
  int points = 0;
  double whole_ms = 0;    // neighbour search and forward pass
  double forward_ms = 0;  // the forward pass on a graph already built
  double plain_ms = 0;
  double whole_ratio = 0, forward_ratio = 0;  // how much longer the plain one takes
};

struct SpeedBench {
  std::vector<SpeedRow> speed;
  std::vector<ReferenceRow> reference;  // of the first network
};

/// 2048, 4096 and 8192 points. All of a row take turns in the same run. `progress` is called with
/// how many of all turns are done; it may be empty and may throw to stop.
SpeedBench measure_speed(std::span<const BenchNetwork> networks,
                         const SpeedBenchOptions& options,
                         const std::function<void(int, int)>& progress = {});

}  // namespace planescope::lab
