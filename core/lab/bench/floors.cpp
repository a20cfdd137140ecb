// Lower bounds of stage times, from memory traffic and arithmetic at this machine's peak rates.

#include "core/lab/bench/floors.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/lab/bench/measuring.hpp"

namespace planescope::lab {
namespace {

constexpr double kPoint = 12, kIndex = 4, kByte = 1;  // bytes

// ---- Peak rates of the machine ----

double copied_bytes_per_s() {
  constexpr std::size_t kBytes = std::size_t{64} << 20;  // larger than caches
  std::vector<char> from(kBytes, 1), to(kBytes, 0);
  double best_ms = 1e30;
  for (int run = 0; run < 8; ++run)
    best_ms = std::min(best_ms, thread_ms([&] {
                         std::memcpy(to.data(), from.data(), kBytes);
                         from[static_cast<std::size_t>(run)] = to[kBytes / 2];  // keeps the copy
                       }));
  return 2.0 * kBytes / (best_ms * 1e-3);
}

// Enough independent sums to hide the latency of the units, each in a register: s = s * a + b.

constexpr int kChains = 12;
constexpr long kSteps = 1'000'000;
constexpr float kFactor = 0.999f, kAddend = 0.001f;  // s stays near 1

typedef float Lanes4 __attribute__((vector_size(16)));
typedef float Lanes8 __attribute__((vector_size(32)));
typedef float Lanes16 __attribute__((vector_size(64)));

/// Explicit vectors: compiler loops would not keep all sums in registers.
template <typename Lanes>
__attribute__((always_inline)) inline float sums() {
  const Lanes zero = {};
  const Lanes factor = zero + kFactor, addend = zero + kAddend;
  Lanes all[kChains];
  for (Lanes& sum : all) sum = addend;
  for (long step = 0; step < kSteps; ++step)
    for (Lanes& sum : all) sum = sum * factor + addend;
  float total = 0;
  for (const Lanes& sum : all) total += sum[0];
  return total;
}

float sums_plain() { return sums<Lanes4>(); }
#if defined(__x86_64__)
__attribute__((target("avx2"))) float sums_avx2() { return sums<Lanes8>(); }
__attribute__((target("avx512f"))) float sums_avx512() { return sums<Lanes16>(); }
#endif

double summed_flops_per_s(Simd simd) {
  float (*sums)() = sums_plain;
  int lanes = 4;
#if defined(__x86_64__)
  if (simd == Simd::avx2) sums = sums_avx2, lanes = 8;
  if (simd == Simd::avx512) sums = sums_avx512, lanes = 16;
#else
  static_cast<void>(simd);
#endif
  double best_ms = 1e30;
  volatile float needed = 0;
  for (int run = 0; run < 8; ++run)
    best_ms = std::min(best_ms, thread_ms([&] { needed = needed + sums(); }));
  return 2.0 * kChains * lanes * kSteps / (best_ms * 1e-3);
}

}  // namespace

Peaks measure_peaks(Simd simd) { return {copied_bytes_per_s(), summed_flops_per_s(simd)}; }

Floor floor_of(const Work& work, const Peaks& peaks) {
  const double bytes_ms = 1e3 * work.bytes / peaks.bytes_per_s;
  const double flops_ms = 1e3 * work.flops / peaks.flops_per_s;
  return {std::max(bytes_ms, flops_ms), bytes_ms >= flops_ms};
}

// ---- Minimum work of the stages ----

namespace {

double real(std::size_t count) { return static_cast<double>(count); }

}  // namespace

Work load_work(std::size_t frame_bytes, std::size_t color_bytes) {
  return {real(frame_bytes + color_bytes), 0};
}

Work gravity_work(std::size_t frame_bytes) { return {real(frame_bytes), 0}; }

Work cloud_work(std::size_t frame_bytes, std::size_t points) {
  return {real(frame_bytes) + (kPoint + kIndex + kByte) * real(points), 17 * real(points)};
}

Work voxel_work(std::size_t points, std::size_t kept, std::size_t voxels) {
  return {kByte * real(points) + kPoint * real(kept) + kIndex * real(points) +
              (kPoint + kIndex) * real(voxels),
          9 * real(kept) + 3 * real(voxels)};
}

Work pca_work(std::size_t points, int neighbors) {
  return {(kPoint + kByte + 4) * real(points), 15.0 * neighbors * real(points)};
}

Work gcn_work(std::size_t points, const planes::NetworkConfig& network) {
  Work work{(kPoint + kByte + 4) * real(points) + 4 * real(planes::parameter_count(network)), 0};
  const double supports = network.supports;
  std::vector<int> head = network.head;
  head.push_back(2);  // h and v
  double n = real(points), in = 0, width = 0;
  for (std::size_t l = 0; l < network.levels.size(); ++l) {
    if (l > 0) n = std::ceil(n / network.pool_rate);
    const double neighbors = std::max(0.0, std::min<double>(network.neighbors, n - 1));
    width = 0;
    for (const int out : network.levels[l]) {
      // Center and supports of every point; the angle with every neighbor, and its product with the
      // neighbor's feature, which the surface convolution lacks.
      work.flops += 2 * n * in * (supports + 1) * out;
      work.flops += n * neighbors * supports * out * (in > 0 ? 6 : 5);
      in = out;
      width += out;
    }
    // The head's first matrix times a level's features: once for each point of the level.
    work.flops += 2 * n * width * head.front();
  }
  if (network.global_feature) work.flops += 2 * in * head.front();
  for (std::size_t h = 1; h < head.size(); ++h)
    work.flops += 2 * real(points) * head[h - 1] * head[h];
  return work;
}

Work octree_work(std::size_t points) {
  const double in = kPoint + kByte, out = 8 + kIndex + kPoint + kByte + kIndex;
  return {(in + out) * real(points), 6 * real(points)};
}

Work segment_work(std::size_t points, std::size_t pixel_points, bool reads_pixels) {
  return {(kPoint + kByte + kIndex) * real(points) +
              (kIndex + (reads_pixels ? kPoint : 0)) * real(pixel_points),
          15 * real(points)};
}

}  // namespace planescope::lab
