#include "core/planes/depth/cells.hpp"

#include <array>
#include <cmath>

#include "core/model/morton.hpp"

namespace planescope::planes {
namespace {

constexpr float kLeavesPerInverseMeter = static_cast<float>(kPxPerInverseMeter) / kLeafPx;
constexpr int kMostLevels = 21;  // three coordinates of 21 bits make a 64-bit code
constexpr float kLastBin = (1 << kMostLevels) - 1;
constexpr int kBlockPixels = kLeafPx * kLeafPx;

/// The pixels of one square that share a bin of rho.
struct Leaf {
  std::uint32_t bin = 0;
  std::uint16_t mask = 0;  // of the square's pixels, row by row
};

struct RawLeaf {
  std::uint16_t mask = 0;
  std::uint16_t block_x = 0, block_y = 0;
  PixelMoments moments;
};

PixelMoments moments_of(const DepthImage& image, int x0, int y0, std::uint16_t mask) {
  // About the square's corner first, where all coordinates are small whole numbers.
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

/// Of a square whose pixels are all measured, and within the image.
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

/// Collects the leaves of all squares, in raster order of these.
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
  int depth = 0;  // of the leaves below the root
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

}  // namespace planescope::planes
