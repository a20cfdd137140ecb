#include "core/planes/depth/noise.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace planescope::planes {
namespace {

constexpr int kSmall = 2, kWide = 8, kHuge = 32;  // sides of squares, in blocks of 4 px
constexpr int kWideStride = 2, kHugeStride = 4;   // blocks between squares: they overlap
constexpr double kOfHuge = 0.64;  // the bow is at most this share of what huge squares show
// RMS of calm squares: of those on one plane. Their mean between two quantiles moves less from
// frame to frame than any one of them.
constexpr double kCalmFrom = 0.15, kCalmTo = 0.35;
// Least share of measured pixels in a square; the second is tried if too few squares reach the
// first.
constexpr double kFull[] = {0.95, 0.5};
constexpr std::size_t kLeast = 6;        // squares
constexpr double kLeastRms = 1e-5;       // [1/m]
constexpr double kBowLength = 1.0 / 32;  // of the image's width

/// Squares of `side` parts at every `stride`; `columns` parts to a row.
struct Squares {
  std::vector<PixelMoments> moments;
  int columns = 0;
};
Squares squares_of(const std::vector<PixelMoments>& parts, int columns, int side, int stride) {
  const int rows = static_cast<int>(parts.size()) / std::max(1, columns);
  Squares squares;
  squares.columns = columns >= side ? (columns - side) / stride + 1 : 0;
  for (int y = 0; y + side <= rows; y += stride)
    for (int x = 0; x + side <= columns; x += stride) {
      PixelMoments& square = squares.moments.emplace_back();
      for (int j = y; j < y + side; ++j)
        for (int i = x; i < x + side; ++i)
          square += parts[static_cast<std::size_t>(j) * columns + i];
    }
  return squares;
}

/// RMS of calm squares about their planes [1/m], -1 where there are too few. `pixels`: of a square.
double calm_rms(const Squares& squares, double pixels) {
  std::vector<double> rms;
  for (const double full : kFull) {
    if (rms.size() >= kLeast) break;
    rms.clear();
    for (const PixelMoments& square : squares.moments)
      if (square.n >= full * pixels) rms.push_back(std::sqrt(square.fit().sse / (square.n - 3)));
  }
  if (rms.size() < kLeast) return -1;
  const auto at = [&](double share) {
    return rms.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(rms.size()));
  };
  const auto from = at(kCalmFrom), to = at(kCalmTo) + 1;
  std::nth_element(rms.begin(), from, rms.end());
  std::nth_element(from, to - 1, rms.end());
  return std::max(kLeastRms, std::accumulate(from, to, 0.0) / static_cast<double>(to - from));
}

/// Standard deviation that rounding to a depth unit makes, at the median of rho [1/m].
double quantization(const std::vector<PixelMoments>& blocks, double unit_m) {
  std::vector<double> rho;
  for (const PixelMoments& block : blocks)
    if (block.n > 0) rho.push_back(block.r / block.n);
  if (rho.empty()) return 0;
  const auto middle = rho.begin() + static_cast<std::ptrdiff_t>(rho.size() / 2);
  std::nth_element(rho.begin(), middle, rho.end());
  return unit_m * *middle * *middle / std::sqrt(12.0);
}

}  // namespace

DepthNoise measure_depth_noise(const std::vector<PixelMoments>& blocks,
                               int columns,
                               int width_px,
                               double unit_m,
                               const ObjectiveOptions& options) {
  DepthNoise noise;
  noise.lateral_px = options.lateral_px;
  noise.length_px = kBowLength * width_px;
  // Wide squares are put together of small ones.
  const Squares parts = squares_of(blocks, columns, kSmall, kSmall);
  double small = calm_rms(squares_of(blocks, columns, kSmall, 1), 64);
  if (small < 0) return noise;
  small = std::max(small, quantization(blocks, unit_m));
  const auto rms_of = [&](int side, int stride) {
    return calm_rms(squares_of(parts.moments, parts.columns, side / kSmall, stride / kSmall),
                    16.0 * side * side);
  };
  const double wide = rms_of(kWide, kWideStride), huge = rms_of(kHuge, kHugeStride);
  noise.white = small;
  noise.wide = std::max(small, wide);
  // It is never nothing: the squares measure it to a fifth of the white noise.
  const auto bow_of = [&](double rms) {
    return std::sqrt(std::max(0.04 * small * small, rms * rms - small * small));
  };
  // Without wide squares, assume a typical bow. Huge squares that lie on one plane show whether the
  // bow keeps growing beyond the wide ones; few frames have any.
  noise.bow = wide < 0 ? 2 * small : bow_of(wide);
  if (huge >= 0) noise.bow = std::min(noise.bow, kOfHuge * bow_of(huge));
  noise.bow *= options.bow;
  return noise;
}

}  // namespace planescope::planes
