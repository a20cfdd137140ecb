// Builds the cells of a depth image and measures its noise.

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/model/morton.hpp"
#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

constexpr float kLeavesPerInverseMeter = static_cast<float>(kPxPerInverseMeter) / kLeafPx;
constexpr int kMostLevels = 21;  // three coordinates of 21 bits make a 64-bit code
constexpr float kLastBin = (1 << kMostLevels) - 1;
constexpr int kBlockPixels = kLeafPx * kLeafPx;

/// The pixels of one square that share a bin of rho.
struct Leaf {
  std::uint32_t bin = 0;
  std::uint16_t mask = 0;  // pixels of the square, row by row
};

struct RawLeaf {
  std::uint16_t mask = 0;
  std::uint16_t block_x = 0, block_y = 0;
  PixelMoments moments;
};

PixelMoments moments_of(const DepthImage& image, int x0, int y0, std::uint16_t mask) {
  // First relative to the square's corner, where all coordinates are small integers.
  PixelMoments m;
  double du = 0, dv = 0, duu = 0, duv = 0, dvv = 0, dur = 0, dvr = 0;
  for (int k = 0; k < kBlockPixels; ++k) {
    if (!(mask >> k & 1)) continue;
    const int x = k % kLeafPx, y = k / kLeafPx;
    const double rho = image.rho[static_cast<std::size_t>(y0 + y) * image.width + x0 + x];
    m.n += 1, m.r += rho, m.rr += rho * rho;
    du += x, dv += y, duu += x * x, duv += x * y, dvv += y * y, dur += x * rho, dvr += y * rho;
  }
  const double u0 = image.u(x0), v0 = image.v(y0);
  m.u = du + m.n * u0;
  m.v = dv + m.n * v0;
  m.uu = duu + 2 * u0 * du + m.n * u0 * u0;
  m.uv = duv + u0 * dv + v0 * du + m.n * u0 * v0;
  m.vv = dvv + 2 * v0 * dv + m.n * v0 * v0;
  m.ur = dur + u0 * m.r;
  m.vr = dvr + v0 * m.r;
  return m;
}

/// Moments of a fully measured square inside the image.
PixelMoments moments_of_full(const DepthImage& image, int x0, int y0) {
  double column[kLeafPx] = {}, row[kLeafPx] = {}, rr = 0;
  for (int y = 0; y < kLeafPx; ++y) {
    const float* const rho = &image.rho[static_cast<std::size_t>(y0 + y) * image.width + x0];
    for (int x = 0; x < kLeafPx; ++x) {
      const double r = rho[x];
      column[x] += r, row[y] += r, rr += r * r;
    }
  }
  const double u0 = image.u(x0), v0 = image.v(y0);
  constexpr double n = kBlockPixels, d = n * (kLeafPx - 1) / 2.0;  // sum of one offset
  constexpr double dd = n * (kLeafPx - 1) * (2 * kLeafPx - 1) / 6.0;
  PixelMoments m;
  m.n = n;
  m.r = row[0] + row[1] + row[2] + row[3];
  m.rr = rr;
  m.u = d + n * u0;
  m.v = d + n * v0;
  m.uu = dd + 2 * u0 * d + n * u0 * u0;
  m.uv = d * d / n + u0 * d + v0 * d + n * u0 * v0;
  m.vv = dd + 2 * v0 * d + n * v0 * v0;
  m.ur = column[1] + 2 * column[2] + 3 * column[3] + u0 * m.r;
  m.vr = row[1] + 2 * row[2] + 3 * row[3] + v0 * m.r;
  return m;
}

/// Collects the leaves of all squares, in raster order of the squares.
class LeafMaker {
 public:
  LeafMaker(const DepthImage& image, DepthCells& cells) : image_(image), cells_(cells) {
    cells.block_columns = image.width / kLeafPx;
    cells.blocks.resize(static_cast<std::size_t>(cells.block_columns) * (image.height / kLeafPx));
    const std::size_t squares = image.pixels() / kBlockPixels;
    codes.reserve(squares + squares / 2);
    leaves.reserve(squares + squares / 2);
    for (int y = 0; y < image.height; y += kLeafPx)
      for (int x = 0; x < image.width; x += kLeafPx) add_square(x, y);
  }

  std::vector<std::uint64_t> codes;
  std::vector<RawLeaf> leaves;
  std::uint32_t greatest_bin = 0;

 private:
  void add_square(int x0, int y0) {
    const int columns = std::min(kLeafPx, image_.width - x0);
    const int rows = std::min(kLeafPx, image_.height - y0);
    std::array<Leaf, kBlockPixels> found;
    int count = 0;
    for (int y = 0; y < rows; ++y) {
      const float* const rho = &image_.rho[static_cast<std::size_t>(y0 + y) * image_.width + x0];
      for (int x = 0; x < columns; ++x) {
        if (rho[x] <= 0) continue;
        const auto bin =
            static_cast<std::uint32_t>(std::min(rho[x] * kLeavesPerInverseMeter, kLastBin));
        int k = 0;
        while (k < count && found[k].bin != bin) ++k;
        if (k == count) found[count++] = {bin, 0};
        found[k].mask |= static_cast<std::uint16_t>(1u << (y * kLeafPx + x));
      }
    }
    PixelMoments all;
    for (int k = 0; k < count; ++k) {
      const PixelMoments moments = found[k].mask == 0xffff
                                       ? moments_of_full(image_, x0, y0)
                                       : moments_of(image_, x0, y0, found[k].mask);
      greatest_bin = std::max(greatest_bin, found[k].bin);
      codes.push_back(morton_code(x0 / kLeafPx, y0 / kLeafPx, found[k].bin));
      leaves.push_back({found[k].mask, static_cast<std::uint16_t>(x0 / kLeafPx),
                        static_cast<std::uint16_t>(y0 / kLeafPx), moments});
      all += moments;
    }
    if (columns == kLeafPx && rows == kLeafPx)
      cells_.blocks[static_cast<std::size_t>(y0 / kLeafPx) * cells_.block_columns + x0 / kLeafPx] =
          all;
  }

  const DepthImage& image_;
  DepthCells& cells_;
};

}  // namespace

DepthCells make_depth_cells(const DepthImage& image) {
  DepthCells cells;
  LeafMaker made(image, cells);
  int depth = 0;  // depth of the leaves below the root
  const auto most = static_cast<std::uint32_t>(
      std::max({(image.width - 1) / kLeafPx, (image.height - 1) / kLeafPx, 1}));
  while (depth < kMostLevels && std::max(most, made.greatest_bin) >> depth != 0) ++depth;

  std::vector<std::uint32_t> order;
  sort_codes(made.codes, order, 3 * depth);
  std::vector<DepthCell>& leaves = cells.levels.emplace_back();
  leaves.reserve(order.size());
  cells.pixels.reserve(image.pixels());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const RawLeaf& raw = made.leaves[order[i]];
    DepthCell& leaf = leaves.emplace_back();
    leaf.code = made.codes[i];
    leaf.moments = raw.moments;
    leaf.first_pixel = static_cast<std::uint32_t>(cells.pixels.size());
    const std::uint32_t corner =
        static_cast<std::uint32_t>(raw.block_y) * kLeafPx * image.width + raw.block_x * kLeafPx;
    for (int k = 0; k < kBlockPixels; ++k)
      if (raw.mask >> k & 1)
        cells.pixels.push_back(corner + (k / kLeafPx) * image.width + k % kLeafPx);
    leaf.end_pixel = static_cast<std::uint32_t>(cells.pixels.size());
  }
  for (int level = 0; level < depth; ++level) {
    const std::vector<DepthCell>& below = cells.levels.back();
    std::vector<DepthCell> above;
    above.reserve(below.size() / 3 + 1);
    for (std::uint32_t i = 0; i < below.size(); ++i) {
      const std::uint64_t code = below[i].code >> 3;
      if (above.empty() || above.back().code != code)
        above.push_back({code, {}, i, i, below[i].first_pixel, below[i].first_pixel});
      above.back().moments += below[i].moments;
      above.back().end = i + 1;
      above.back().end_pixel = below[i].end_pixel;
    }
    cells.levels.push_back(std::move(above));
  }
  return cells;
}

// ---- Noise ----

namespace {

constexpr int kSmall = 2, kWide = 8, kHuge = 32;  // sides of squares, in blocks of 4 px
constexpr int kWideStride = 2, kHugeStride = 4;   // blocks between squares: they overlap
constexpr double kOfHuge = 0.64;  // upper bound on the bow, as a share of the bow in huge squares
// Calm squares are those on one plane: the lower quantiles of RMS. The mean between two quantiles
// varies less from frame to frame than a single quantile.
constexpr double kCalmFrom = 0.15, kCalmTo = 0.35;
// Smallest share of measured pixels in a square. If too few squares reach the first value, the
// second is tried.
constexpr double kFull[] = {0.95, 0.5};
constexpr std::size_t kLeast = 6;        // squares
constexpr double kLeastRms = 1e-5;       // [1/m]
constexpr double kBowLength = 1.0 / 32;  // share of the image's width

/// Squares of `side` parts at every `stride`, with `columns` parts per row.
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

/// RMS of calm squares about their planes [1/m]; -1 if there are too few. `pixels`: per square.
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

/// Standard deviation caused by rounding to a depth unit, at the median of rho [1/m].
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
  // Wide squares are assembled from small ones.
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
  // Never zero: squares can only resolve it to a fifth of the white noise.
  const auto bow_of = [&](double rms) {
    return std::sqrt(std::max(0.04 * small * small, rms * rms - small * small));
  };
  // Without wide squares, assume a typical bow. Huge squares on a single plane (available in
  // few frames) show whether the bow keeps growing beyond the wide squares.
  noise.bow = wide < 0 ? 2 * small : bow_of(wide);
  if (huge >= 0) noise.bow = std::min(noise.bow, kOfHuge * bow_of(huge));
  noise.bow *= options.bow;
  return noise;
}

}  // namespace planescope::planes
