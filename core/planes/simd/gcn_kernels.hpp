#pragma once

// Inner loops of a 3D-GCN, compiled once per instruction set. Lanes run over channels and sums run
// in index order, so every instruction set returns identical bits. Only raw pointers, so that no
// inline function compiled for one instruction set is linked into code for all.

#include <cstddef>
#include <cstdint>

#include "core/model/parallel.hpp"

namespace planescope::planes::gcn {

/// Channel counts are zero-padded to multiples of this.
inline constexpr int kLanes = 16;

/// Unit vectors from each point to its neighbors; zero for coincident points.
struct DirectionArgs {
  std::size_t begin = 0, end = 0;
  int neighbors = 0;
  const float* points = nullptr;        // [n x 3]
  const std::uint32_t* rows = nullptr;  // [n x k]
  float* directions = nullptr;          // [n x 3 x k]
};

/// Graph convolution (Lin et al. 2020, Sec. 3.2-3.3), excluding the product with the weights:
/// out[i][c] = center[i][c] + sum over s of max over j of relu(directions[i][j] . kernels[s][c])
///             * features[rows[i][j]][s][c].
/// Surface convolution if `features` is null: without that factor and without the center term.
struct SupportArgs {
  std::size_t begin = 0, end = 0;       // points i
  int neighbors = 0;                    // k; the maximum over no neighbors is 0
  const float* directions = nullptr;    // [n x 3 x k] unit vectors to the neighbors, or zero
  const std::uint32_t* rows = nullptr;  // [n x k]
  int supports = 1, channels = 0;
  const float* kernels = nullptr;   // [3 x supports x channels] unit columns
  const float* features = nullptr;  // [n x stride]
  const float* center = nullptr;    // [n x stride]
  std::size_t stride = 0;
  float* out = nullptr;  // [n x out_stride]
  std::size_t out_stride = 0;
  bool relu = true;
  std::uint16_t* winners = nullptr;  // [n x supports x channels] j of each maximum; may be null
};

/// y[i] = bias + x[i] * w for rows begin..end.
struct ProductArgs {
  std::size_t begin = 0, end = 0;
  const float* x = nullptr;  // [n x x_stride]; only the first `inner` columns are used
  std::size_t x_stride = 0;
  int inner = 0, outer = 0;
  const float* w = nullptr;     // [inner x outer]
  const float* bias = nullptr;  // [outer]; may be null
  float* y = nullptr;           // [n x y_stride]
  std::size_t y_stride = 0;
  bool accumulate = false;  // start from y instead of the bias
  bool relu = false;
};

/// w[a][b] += sum over rows i < n of x[i][a] y[i][b].
struct OuterArgs {
  std::size_t n = 0;
  const float* x = nullptr;
  std::size_t x_stride = 0;
  const float* y = nullptr;
  std::size_t y_stride = 0;
  int inner = 0, outer = 0;
  float* w = nullptr;  // [inner x outer]
};

struct Kernels {
  void (*direct)(const DirectionArgs&);
  void (*support)(const SupportArgs&);
  void (*product)(const ProductArgs&);
  void (*outer)(const OuterArgs&);
};

extern const Kernels kKernelsPlain, kKernelsAvx2, kKernelsAvx512;
const Kernels& kernels(Simd simd);

}  // namespace planescope::planes::gcn
