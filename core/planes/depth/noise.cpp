#include "core/planes/depth/noise.hpp"

#include <cmath>

namespace planescope::planes {
namespace {

constexpr int kBlock = 4;             // px
constexpr double kCalm = 0.25;        // quantile of the RMS that stands for squares on one plane
constexpr double kFull = 0.95;        // share of its pixels that a square must have measured
constexpr std::size_t kLeast = 6;     // squares
constexpr double kLeastRms = 1e-5;    // [1/m]
constexpr double kBowLength = 1.0 / 32;  // of the image's width

/// RMS of calm squares of `side` px about their planes [1/m], -1 where there are too few.
double calm_rms(const std::vector<PixelMoments>& blocks, int columns, int side) {
  const int step = side / kBlock, rows = static_cast<int>(blocks.size()) / std::max(1, columns);
  std::vector<double> rms;
  for (int y = 0; y + step <= rows; y += step)
    for (int x = 0; x + step <= columns; x += step) {
      PixelMoments square;
      for (int j = y; j < y + step; ++j)
        for (int i = x; i < x + step; ++i)
          square += blocks[static_cast<std::size_t>(j) * columns + i];
      if (square.n >= kFull * side * side)
        rms.push_back(std::sqrt(square.fit().sse / (square.n - 3)));
    }
  if (rms.size() < kLeast) return -1;
  const auto calm = rms.begin() + static_cast<std::ptrdiff_t>(kCalm * static_cast<double>(rms.size()));
  std::nth_element(rms.begin(), calm, rms.end());
  return std::max(kLeastRms, *calm);
}

}  // namespace

DepthNoise measure_depth_noise(const std::vector<PixelMoments>& blocks,
                               int columns,
                               int width_px,
                               const ObjectiveOptions& options) {
  DepthNoise noise;
  noise.lateral_px = options.lateral_px;
  noise.length_px = kBowLength * width_px;
  const double small = calm_rms(blocks, columns, 8), wide = calm_rms(blocks, columns, 32);
  if (small < 0) return noise;
  noise.white = small;
  // Where nothing is wide enough to show the bow, it is taken to be as usual. It is never nothing:
  // the squares measure it to a fifth of the white noise.
  const double more2 = wide < 0 ? 4 * small * small : wide * wide - small * small;
  noise.wide = std::max(small, wide);
  noise.bow = options.bow * std::sqrt(std::max(0.04 * small * small, more2));
  return noise;
}

}  // namespace planescope::planes
