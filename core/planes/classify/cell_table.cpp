#include "core/planes/classify/cell_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/model/morton.hpp"

namespace planescope::planes {
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

ZOrder order_in(const ZFrame& frame, std::span<const Vec3f> points) {
  ZOrder z{frame, std::vector<std::uint64_t>(points.size()), {}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d q = frame.in_cells(points[i]);
    z.codes[i] = morton_code(static_cast<std::uint32_t>(q.x()), static_cast<std::uint32_t>(q.y()),
                             static_cast<std::uint32_t>(q.z()));
  }
  sort_codes(z.codes, z.order, 3 * kZBits);
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

namespace {

/// Unique among all levels: the code behind a leading one.
std::uint64_t make_key(std::uint64_t parent, int level) {
  return parent | std::uint64_t{1} << 3 * (kZBits - 1 - level);
}

/// The highest level at which a cell begins with point i; -1 for none.
int highest_begun(std::span<const std::uint64_t> codes, std::size_t i) {
  if (i == 0) return kZBits;
  const std::uint64_t differs = codes[i] ^ codes[i - 1];
  return differs != 0 ? (63 - std::countl_zero(differs)) / 3 : -1;
}

Siblings search(std::span<const std::uint64_t> codes, std::uint64_t parent, int level) {
  Siblings found;
  for (std::uint64_t i = 0; i <= 8; ++i) {
    const auto at = std::lower_bound(codes.begin() + found.begin[i > 0 ? i - 1 : 0], codes.end(),
                                     (parent * 8 + i) << 3 * level);
    found.begin[i] = static_cast<std::uint32_t>(at - codes.begin());
    if (i > 0 && found.begin[i] > found.begin[i - 1])
      found.occupied = static_cast<std::uint8_t>(found.occupied | 1 << (i - 1));
  }
  return found;
}

}  // namespace

CellTable::CellTable(std::span<const std::uint64_t> codes, int level) : level_(level) {
  std::size_t parents = 0;
  for (std::size_t i = 0; i < codes.size(); ++i)
    parents += static_cast<std::size_t>(std::max(0, highest_begun(codes, i) - level));
  const std::size_t capacity = std::bit_ceil(2 * parents + 2);
  shift_ = 64 - std::countr_zero(capacity);
  slots_.resize(capacity);

  struct Open {
    Siblings siblings;
    std::uint32_t known = 0;  // how many of siblings.begin
    void know(std::uint32_t up_to, std::size_t point) {
      while (known <= up_to) siblings.begin[known++] = static_cast<std::uint32_t>(point);
    }
  };
  std::array<Open, kZBits> open;  // by level of the siblings
  for (std::size_t i = 0; i <= codes.size() && !codes.empty(); ++i) {
    const bool end = i == codes.size();
    const int begun = end ? kZBits : highest_begun(codes, i);
    for (int l = level; l < kZBits && l <= begun; ++l) {
      if (i > 0 && begun > l) {  // their parent ends here
        open[l].know(8, i);
        insert(make_key(codes[i - 1] >> 3 * (l + 1), l), open[l].siblings);
        open[l] = {};
      }
      if (end) continue;
      const auto child = static_cast<std::uint32_t>(codes[i] >> 3 * l & 7);
      open[l].know(child, i);
      open[l].siblings.occupied = static_cast<std::uint8_t>(open[l].siblings.occupied | 1 << child);
    }
  }
}

void CellTable::insert(std::uint64_t key, const Siblings& siblings) {
  std::size_t i = home(key);
  while (slots_[i].key != 0) i = (i + 1) & (slots_.size() - 1);
  slots_[i] = {key, siblings};
}

Siblings CellTable::find(std::span<const std::uint64_t> codes,
                         std::uint64_t parent,
                         int level) const {
  if (level < level_) return search(codes, parent, level);
  const std::uint64_t key = make_key(parent, level);
  for (std::size_t i = home(key);; i = (i + 1) & (slots_.size() - 1)) {
    if (slots_[i].key == key) return slots_[i].siblings;
    if (slots_[i].key == 0) return {};
  }
}

}  // namespace planescope::planes
