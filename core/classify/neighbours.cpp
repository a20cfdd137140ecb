// Exact neighbours by an implicit octree: points sorted by Morton code, every cell of every level
// a range of them. A query looks at the 3x3x3 cells around its own, and one level up for as long as
// its k-th neighbour could still lie outside of them.

#include "core/classify/neighbours.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "core/base/parallel.hpp"

namespace planescope {
namespace {

constexpr int kBits = 21;  // per axis, at level 0 (the finest); level kBits is one cell

std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

using Cell = std::array<std::int64_t, 3>;  // integer coordinates at some level

std::uint64_t morton(const Cell& c) {
  return spread(static_cast<std::uint64_t>(c[0])) | spread(static_cast<std::uint64_t>(c[1])) << 1 |
         spread(static_cast<std::uint64_t>(c[2])) << 2;
}

struct Index {
  Vec3d min_corner = Vec3d::Zero();
  double fine_cell_m = 0;            // edge of a cell of level 0
  std::vector<std::uint64_t> codes;  // ascending, level 0
  std::vector<std::uint32_t> order;  // order[i]: point of codes[i]
  std::vector<Vec3f> points;         // in that order
  int level = 0;                     // where queries begin
  std::vector<std::uint32_t> cells;  // first point of every cell of `level`, and n

  Vec3d in_fine_cells(const Vec3f& p) const {
    return (p.cast<double>() - min_corner) / fine_cell_m;
  }
  Cell cell(const Vec3f& p, int at_level) const {
    const Vec3d q = in_fine_cells(p);
    Cell c;
    for (int axis = 0; axis < 3; ++axis)
      c[axis] = std::clamp<std::int64_t>(static_cast<std::int64_t>(q[axis]), 0,
                                         (std::int64_t{1} << kBits) - 1) >>
                at_level;
    return c;
  }
};

/// The finest level whose occupied cells hold `per_cell` points on average.
int starting_level(const std::vector<std::uint64_t>& codes, double per_cell) {
  std::array<std::size_t, kBits + 1> parted{};  // neighbours in order that part above level l
  for (std::size_t i = 1; i < codes.size(); ++i) {
    const std::uint64_t differs = codes[i] ^ codes[i - 1];
    if (differs == 0) continue;
    ++parted[(63 - std::countl_zero(differs)) / 3];
  }
  std::size_t occupied = codes.size();
  for (int level = 0; level <= kBits; ++level) {
    occupied = 1;
    for (int l = level; l < kBits; ++l) occupied += parted[l];
    if (static_cast<double>(codes.size()) >= per_cell * static_cast<double>(occupied)) return level;
  }
  return kBits;
}

Index make_index(std::span<const Vec3f> points, int k) {
  Index index;
  Eigen::AlignedBox3d bounds;
  for (const Vec3f& p : points) bounds.extend(p.cast<double>());
  index.min_corner = bounds.min();
  const double edge_m = bounds.sizes().maxCoeff();
  index.fine_cell_m = (edge_m > 0 ? edge_m : 1.0) / static_cast<double>((1 << kBits) - 1);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    sorted[i] = {morton(index.cell(points[i], 0)), static_cast<std::uint32_t>(i)};
  std::sort(sorted.begin(), sorted.end());
  index.codes.reserve(points.size());
  index.order.reserve(points.size());
  index.points.reserve(points.size());
  for (const auto& [code, i] : sorted) {
    index.codes.push_back(code);
    index.order.push_back(i);
    index.points.push_back(points[i]);
  }
  // On a surface the k nearest fill a disc; a third of them per cell lets 3x3 cells hold the disc.
  index.level = starting_level(index.codes, k / 3.0);
  for (std::uint32_t i = 0; i < index.codes.size(); ++i)
    if (i == 0 || (index.codes[i] >> 3 * index.level) != (index.codes[i - 1] >> 3 * index.level))
      index.cells.push_back(i);
  index.cells.push_back(static_cast<std::uint32_t>(index.codes.size()));
  return index;
}

struct Range {
  std::uint32_t begin, end;
};

/// The points of the cell with this code at this level.
Range find_cell(const Index& index, std::uint64_t code, int level) {
  const int shift = 3 * level;
  const auto first_at = [&](std::uint64_t value) {
    const auto it = std::lower_bound(index.codes.begin(), index.codes.end(), value);
    return static_cast<std::uint32_t>(it - index.codes.begin());
  };
  if (level == index.level) {
    const auto it = std::lower_bound(
        index.cells.begin(), index.cells.end() - 1, code,
        [&](std::uint32_t i, std::uint64_t c) { return (index.codes[i] >> shift) < c; });
    if (it == index.cells.end() - 1 || (index.codes[*it] >> shift) != code) return {0, 0};
    return {*it, *(it + 1)};
  }
  return {first_at(code << shift), first_at((code + 1) << shift)};
}

/// Candidates of one 3x3x3 block, and the scratch of one thread.
struct Block {
  std::vector<std::uint32_t> slots;  // positions in Index::points
  std::vector<float> x, y, z;
  std::vector<std::uint64_t> keyed;  // squared distance, then candidate: sorts by distance
  std::vector<std::uint32_t> near;
};

void gather(const Index& index, const Cell& center, int level, Block& block) {
  block.slots.clear();
  const std::int64_t cells = std::int64_t{1} << (kBits - level);
  const auto add = [&](Range range) {
    for (std::uint32_t i = range.begin; i < range.end; ++i) block.slots.push_back(i);
  };
  for (std::int64_t dz = -1; dz <= 1; ++dz)
    for (std::int64_t dy = -1; dy <= 1; ++dy)
      for (std::int64_t dx = -1; dx <= 1; ++dx) {
        const Cell c{center[0] + dx, center[1] + dy, center[2] + dz};
        if (std::all_of(c.begin(), c.end(), [&](std::int64_t v) { return v >= 0 && v < cells; }))
          add(find_cell(index, morton(c), level));
      }
  const std::size_t n = block.slots.size();
  block.x.resize(n);
  block.y.resize(n);
  block.z.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f& p = index.points[block.slots[i]];
    block.x[i] = p.x();
    block.y[i] = p.y();
    block.z[i] = p.z();
  }
}

/// How far from `p` the block around its cell surely reaches [m]; infinite for the topmost cell.
double reach_m(const Index& index, const Vec3f& p, int level) {
  if (level >= kBits) return std::numeric_limits<double>::infinity();
  const Vec3d q = index.in_fine_cells(p);
  const Cell c = index.cell(p, level);
  const double edge = static_cast<double>(std::int64_t{1} << level);
  double reach = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double into_cell = q[axis] - static_cast<double>(c[axis]) * edge;
    reach = std::min({reach, edge + into_cell, 2 * edge - into_cell});
  }
  return reach * index.fine_cell_m * (1 - 1e-5);  // less what float distances round off
}

/// Writes the k nearest of the block's candidates; false if others might be nearer.
bool select(
    const Index& index, const Vec3f& p, int k, double reach, Block& block, std::uint32_t* row) {
  const std::size_t n = block.slots.size();
  if (n < static_cast<std::size_t>(k) && std::isfinite(reach)) return false;
  block.keyed.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = block.x[i] - p.x(), dy = block.y[i] - p.y(), dz = block.z[i] - p.z();
    const float squared = dx * dx + dy * dy + dz * dz;
    block.keyed[i] = std::uint64_t{std::bit_cast<std::uint32_t>(squared)} << 32 | i;
  }
  const std::size_t wanted = std::min<std::size_t>(static_cast<std::size_t>(k), n);
  const auto kth = block.keyed.begin() + static_cast<std::ptrdiff_t>(wanted) - 1;
  std::nth_element(block.keyed.begin(), kth, block.keyed.end());
  const std::uint64_t farthest = *kth >> 32;
  const double farthest_squared = std::bit_cast<float>(static_cast<std::uint32_t>(farthest));
  if (std::isfinite(reach) && !(farthest_squared < reach * reach)) return false;

  // Everything at the k-th distance competes for the last places, whatever nth_element kept.
  const auto ties = std::partition(kth + 1, block.keyed.end(),
                                   [&](std::uint64_t key) { return key >> 32 == farthest; });
  std::sort(block.keyed.begin(), ties, [&](std::uint64_t a, std::uint64_t b) {
    if (a >> 32 != b >> 32) return a < b;
    const std::uint32_t i = block.slots[a & 0xffffffff], j = block.slots[b & 0xffffffff];
    const Vec3f &s = index.points[i], &t = index.points[j];
    if (s.x() != t.x()) return s.x() < t.x();
    if (s.y() != t.y()) return s.y() < t.y();
    if (s.z() != t.z()) return s.z() < t.z();
    return index.order[i] < index.order[j];
  });
  for (std::size_t i = 0; i < wanted; ++i)
    row[i] = index.order[block.slots[block.keyed[i] & 0xffffffff]];
  return true;
}

}  // namespace

std::vector<std::uint32_t> nearest_neighbours(std::span<const Vec3f> points, int k, int threads) {
  std::vector<std::uint32_t> rows(points.size() * static_cast<std::size_t>(std::max(k, 0)),
                                  kNoNeighbour);
  if (rows.empty()) return rows;
  const Index index = make_index(points, k);
  const auto query_cells = [&](std::size_t first, std::size_t last) {
    Block around_cell, wider;
    for (std::size_t c = first; c < last; ++c) {
      const Cell center = index.cell(index.points[index.cells[c]], index.level);
      gather(index, center, index.level, around_cell);
      for (std::uint32_t i = index.cells[c]; i < index.cells[c + 1]; ++i) {
        const Vec3f& p = index.points[i];
        std::uint32_t* row =
            rows.data() + std::size_t{index.order[i]} * static_cast<std::size_t>(k);
        if (select(index, p, k, reach_m(index, p, index.level), around_cell, row)) continue;
        for (int level = index.level + 1;; ++level) {
          gather(index, index.cell(p, level), level, wider);
          if (select(index, p, k, reach_m(index, p, level), wider, row)) break;
        }
      }
    }
  };
  parallel_for(index.cells.size() - 1, threads, query_cells, 64);
  return rows;
}

}  // namespace planescope
