// Included by kernels_{plain,avx2,avx512}.cpp, which define PLANESCOPE_LANES (floats per register)
// and PLANESCOPE_TILE (rows of a matrix product that share its weights). Compared with AVX-512, the
// network takes 1.9 times as long with baseline registers and 1.4 times with AVX2.

#include "core/planes/simd/gcn_kernels.hpp"

namespace planescope::planes::gcn {
namespace {

constexpr int kWidth = PLANESCOPE_LANES;
constexpr int kTile = PLANESCOPE_TILE;
using Lanes = float __attribute__((vector_size(kWidth * sizeof(float))));
using LanesI = std::int32_t __attribute__((vector_size(kWidth * sizeof(std::int32_t))));

inline Lanes load(const float* p) {
  Lanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline void store(float* p, Lanes v) { __builtin_memcpy(p, &v, sizeof v); }
inline Lanes all(float v) { return Lanes{} + v; }
inline Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes relu(Lanes v) { return larger(v, Lanes{}); }

void direct(const DirectionArgs& a) {
  const int k = a.neighbors;
  for (std::size_t i = a.begin; i < a.end; ++i) {
    const float* p = a.points + 3 * i;
    const std::uint32_t* row = a.rows + i * k;
    float* out = a.directions + i * 3 * k;
    for (int j = 0; j < k; ++j)
      for (int axis = 0; axis < 3; ++axis)
        out[axis * k + j] = a.points[3 * std::size_t{row[j]} + axis] - p[axis];
    float* x = out;
    float* y = out + k;
    float* z = out + 2 * k;
    for (int j = 0; j < k; ++j) {
      const float length = __builtin_sqrtf(x[j] * x[j] + y[j] * y[j] + z[j] * z[j]);
      const float scale = length > 0 ? 1 / length : 0.0f;
      x[j] *= scale;
      y[j] *= scale;
      z[j] *= scale;
    }
  }
}

// Processes kGroup registers of channels at a time, starting at channel c.
template <int kGroup, bool kSurface, bool kWinners>
inline void support_group(const SupportArgs& a, std::size_t i, int c) {
  const int all_channels = a.supports * a.channels;
  const float* x_to = a.directions + i * a.neighbors * 3;
  const float* y_to = x_to + a.neighbors;
  const float* z_to = y_to + a.neighbors;
  const std::uint32_t* row = a.rows + i * a.neighbors;
  Lanes sum[kGroup];
  for (int g = 0; g < kGroup; ++g)
    sum[g] = kSurface ? Lanes{} : load(a.center + i * a.stride + c + g * kWidth);
  for (int s = 0; s < a.supports; ++s) {
    const int first = s * a.channels + c;
    Lanes x[kGroup], y[kGroup], z[kGroup], best[kGroup];
    LanesI winner[kGroup];
    for (int g = 0; g < kGroup; ++g) {
      x[g] = load(a.kernels + first + g * kWidth);
      y[g] = load(a.kernels + all_channels + first + g * kWidth);
      z[g] = load(a.kernels + 2 * all_channels + first + g * kWidth);
      best[g] = Lanes{};
      winner[g] = LanesI{};
    }
    for (int j = 0; j < a.neighbors; ++j) {
      const Lanes dx = all(x_to[j]), dy = all(y_to[j]), dz = all(z_to[j]);
      const float* feature = kSurface ? nullptr : a.features + row[j] * a.stride + first;
      for (int g = 0; g < kGroup; ++g) {
        Lanes value = relu(dx * x[g] + dy * y[g] + dz * z[g]);
        if constexpr (!kSurface) value *= load(feature + g * kWidth);
        if (j == 0) {
          best[g] = value;
          continue;
        }
        if constexpr (kWinners) winner[g] = value > best[g] ? LanesI{} + j : winner[g];
        best[g] = larger(value, best[g]);
      }
    }
    for (int g = 0; g < kGroup; ++g) sum[g] += best[g];
    if constexpr (kWinners)
      for (int g = 0; g < kGroup; ++g)
        for (int lane = 0; lane < kWidth; ++lane)
          a.winners[i * all_channels + first + g * kWidth + lane] =
              static_cast<std::uint16_t>(winner[g][lane]);
  }
  for (int g = 0; g < kGroup; ++g)
    store(a.out + i * a.out_stride + c + g * kWidth, a.relu ? relu(sum[g]) : sum[g]);
}

template <bool kSurface, bool kWinners>
void support_rows(const SupportArgs& a) {
  constexpr int kGroup = kWidth == 16 ? 4 : 2;
  for (std::size_t i = a.begin; i < a.end; ++i) {
    int c = 0;
    for (; c + kGroup * kWidth <= a.channels; c += kGroup * kWidth)
      support_group<kGroup, kSurface, kWinners>(a, i, c);
    for (; c + 2 * kWidth <= a.channels; c += 2 * kWidth)
      support_group<2, kSurface, kWinners>(a, i, c);
    for (; c < a.channels; c += kWidth) support_group<1, kSurface, kWinners>(a, i, c);
  }
}

void support(const SupportArgs& a) {
  if (a.features)
    a.winners ? support_rows<false, true>(a) : support_rows<false, false>(a);
  else
    a.winners ? support_rows<true, true>(a) : support_rows<true, false>(a);
}

template <int kRows, int kGroup>
inline void product_tile(const ProductArgs& a, std::size_t i, int b) {
  Lanes sum[kRows][kGroup];
  for (int r = 0; r < kRows; ++r)
    for (int g = 0; g < kGroup; ++g)
      sum[r][g] = a.accumulate ? load(a.y + (i + r) * a.y_stride + b + g * kWidth)
                  : a.bias     ? load(a.bias + b + g * kWidth)
                               : Lanes{};
  const float* x = a.x + i * a.x_stride;
  const float* w = a.w + b;
  for (int t = 0; t < a.inner; ++t, w += a.outer)
    for (int g = 0; g < kGroup; ++g) {
      const Lanes factor = load(w + g * kWidth);
      for (int r = 0; r < kRows; ++r) sum[r][g] += all(x[r * a.x_stride + t]) * factor;
    }
  for (int r = 0; r < kRows; ++r)
    for (int g = 0; g < kGroup; ++g)
      store(a.y + (i + r) * a.y_stride + b + g * kWidth, a.relu ? relu(sum[r][g]) : sum[r][g]);
}

template <int kGroup>
inline void product_columns(const ProductArgs& a, int b) {
  std::size_t i = a.begin;
  for (; i + kTile <= a.end; i += kTile) product_tile<kTile, kGroup>(a, i, b);
  for (; i < a.end; ++i) product_tile<1, kGroup>(a, i, b);
}

void product(const ProductArgs& a) {
  int b = 0;
  for (; b + 2 * kWidth <= a.outer; b += 2 * kWidth) product_columns<2>(a, b);
  for (; b < a.outer; b += kWidth) product_columns<1>(a, b);
}

template <int kRows, int kGroup>
inline void outer_tile(const OuterArgs& a, int row, int b) {
  Lanes sum[kRows][kGroup];
  for (int r = 0; r < kRows; ++r)
    for (int g = 0; g < kGroup; ++g) sum[r][g] = load(a.w + (row + r) * a.outer + b + g * kWidth);
  for (std::size_t i = 0; i < a.n; ++i) {
    const float* x = a.x + i * a.x_stride + row;
    const float* y = a.y + i * a.y_stride + b;
    for (int g = 0; g < kGroup; ++g) {
      const Lanes factor = load(y + g * kWidth);
      for (int r = 0; r < kRows; ++r) sum[r][g] += all(x[r]) * factor;
    }
  }
  for (int r = 0; r < kRows; ++r)
    for (int g = 0; g < kGroup; ++g) store(a.w + (row + r) * a.outer + b + g * kWidth, sum[r][g]);
}

template <int kGroup>
inline void outer_columns(const OuterArgs& a, int b) {
  int row = 0;
  for (; row + kTile <= a.inner; row += kTile) outer_tile<kTile, kGroup>(a, row, b);
  for (; row < a.inner; ++row) outer_tile<1, kGroup>(a, row, b);
}

void outer(const OuterArgs& a) {
  int b = 0;
  for (; b + 2 * kWidth <= a.outer; b += 2 * kWidth) outer_columns<2>(a, b);
  for (; b < a.outer; b += kWidth) outer_columns<1>(a, b);
}

}  // namespace
}  // namespace planescope::planes::gcn
