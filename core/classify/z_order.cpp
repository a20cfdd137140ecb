#include "core/classify/z_order.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace planescope {
namespace {

/// Points per occupied cell, by level.
std::array<double, kZBits + 1> occupancy(std::span<const std::uint64_t> codes) {
  std::array<std::size_t, kZBits + 1> parted{};  // neighbours in order that part below this level
  for (std::size_t i = 1; i < codes.size(); ++i)
    if (const std::uint64_t differs = codes[i] ^ codes[i - 1])
      ++parted[(63 - std::countl_zero(differs)) / 3 + 1];
  std::array<double, kZBits + 1> points_per_cell{};
  std::size_t cells = 1;
  for (int level = kZBits; level >= 0; --level) {
    points_per_cell[level] = static_cast<double>(codes.size()) / static_cast<double>(cells);
    cells += parted[level];
  }
  return points_per_cell;
}

/// Sorts codes, and the order with them, by their 11-bit digits; stable.
void radix_sort(std::vector<std::uint64_t>& codes, std::vector<std::uint32_t>& order) {
  constexpr int kDigitBits = 11, kDigits = (3 * kZBits + kDigitBits - 1) / kDigitBits;
  constexpr std::uint64_t kMask = (1 << kDigitBits) - 1;
  std::array<std::array<std::uint32_t, kMask + 1>, kDigits> starts{};
  for (const std::uint64_t code : codes)
    for (int digit = 0; digit < kDigits; ++digit)
      ++starts[digit][code >> digit * kDigitBits & kMask];
  std::vector<std::uint64_t> sorted_codes(codes.size());
  std::vector<std::uint32_t> sorted_order(codes.size());
  for (int digit = 0; digit < kDigits; ++digit) {
    const int shift = digit * kDigitBits;
    auto& start = starts[digit];
    if (!codes.empty() && start[codes[0] >> shift & kMask] == codes.size()) continue;
    std::exclusive_scan(start.begin(), start.end(), start.begin(), 0U);
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const std::uint32_t to = start[codes[i] >> shift & kMask]++;
      sorted_codes[to] = codes[i];
      sorted_order[to] = order[i];
    }
    codes.swap(sorted_codes);
    order.swap(sorted_order);
  }
}

ZOrder order_in(const ZFrame& frame, std::span<const Vec3f> points) {
  ZOrder z{frame, std::vector<std::uint64_t>(points.size()),
           std::vector<std::uint32_t>(points.size())};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d q = frame.in_cells(points[i]);
    z.codes[i] = z_spread(static_cast<std::int32_t>(q.x())) |
                 z_spread(static_cast<std::int32_t>(q.y())) << 1 |
                 z_spread(static_cast<std::int32_t>(q.z())) << 2;
  }
  std::iota(z.order.begin(), z.order.end(), 0U);
  radix_sort(z.codes, z.order);
  return z;
}

void break_ties(std::span<const Vec3f> points, ZOrder& z) {
  for (std::size_t begin = 0, end = 0; begin < z.codes.size(); begin = end) {
    while (end < z.codes.size() && z.codes[end] == z.codes[begin]) ++end;
    if (end - begin == 1) continue;
    std::sort(z.order.begin() + static_cast<std::ptrdiff_t>(begin),
              z.order.begin() + static_cast<std::ptrdiff_t>(end),
              [&](std::uint32_t i, std::uint32_t j) {
                const Vec3f &p = points[i], &q = points[j];
                if (p.x() != q.x()) return p.x() < q.x();
                if (p.y() != q.y()) return p.y() < q.y();
                if (p.z() != q.z()) return p.z() < q.z();
                return i < j;
              });
  }
}

}  // namespace

std::uint64_t z_spread(std::int32_t value) {
  auto v = static_cast<std::uint64_t>(value);
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

int z_level(std::span<const std::uint64_t> codes, double per_cell) {
  const auto points_per_cell = occupancy(codes);
  int level = 0;
  while (level < kZBits && points_per_cell[level] < 0.7 * per_cell) ++level;
  return level;
}

ZOrder z_order(std::span<const Vec3f> points, double per_cell) {
  ZFrame frame;
  Eigen::AlignedBox3f bounds;
  for (const Vec3f& p : points) bounds.extend(p);
  if (points.empty()) return {};
  frame.min_corner = bounds.min().cast<double>();
  const double edge_m = (bounds.max().cast<double>() - frame.min_corner).maxCoeff();
  frame.cells_per_m = ((1 << kZBits) - 1) / (edge_m > 0 ? edge_m : 1.0);
  ZOrder z = order_in(frame, points);

  // Levels differ by a factor of two in edge; the last bit is in the size of the cells. Between two
  // levels the count grows with the square of the edge, for points lie on surfaces.
  const auto points_per_cell = occupancy(z.codes);
  int above = 0;
  while (above < kZBits && points_per_cell[above] <= per_cell) ++above;
  if (above > 0 && points_per_cell[above] > per_cell) {
    const double fine = points_per_cell[above - 1], coarse = points_per_cell[above];
    frame.cells_per_m /= std::sqrt(1 + 3 * (per_cell - fine) / (coarse - fine));
    z = order_in(frame, points);
  }
  break_ties(points, z);
  return z;
}

}  // namespace planescope
