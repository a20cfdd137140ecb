// Exact k nearest neighbors over cells of a Morton-ordered cloud.

#include "core/planes/classify/neighbour_grid.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "core/model/morton.hpp"
#include "core/planes/classify/neighbour_kernels.hpp"

namespace planescope::planes {

// ---- Cells along the curve ----

namespace {

/// Points per occupied cell, by level.
std::array<double, kZBits + 1> occupancy(std::span<const std::uint64_t> codes) {
  std::array<std::size_t, kZBits + 1> parted{};  // consecutive pairs that separate below this level
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

  // Edges of successive levels differ by a factor of two; the cell size supplies the rest. Between
  // levels, the count grows with the square of the edge because the points sample surfaces.
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

/// Key that is unique across levels: the code behind a leading one.
std::uint64_t make_key(std::uint64_t parent, int level) {
  return parent | std::uint64_t{1} << 3 * (kZBits - 1 - level);
}

/// Highest level at which a cell begins with point i; -1 if none.
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
    std::uint32_t count = 0;  // number of entries of siblings.begin that are set
    void set_until(std::uint32_t up_to, std::size_t point) {
      while (count <= up_to) siblings.begin[count++] = static_cast<std::uint32_t>(point);
    }
  };
  std::array<Open, kZBits> open;  // by level of the siblings
  for (std::size_t i = 0; i <= codes.size() && !codes.empty(); ++i) {
    const bool end = i == codes.size();
    const int begun = end ? kZBits : highest_begun(codes, i);
    for (int l = level; l < kZBits && l <= begun; ++l) {
      if (i > 0 && begun > l) {  // the parent ends here
        open[l].set_until(8, i);
        insert(make_key(codes[i - 1] >> 3 * (l + 1), l), open[l].siblings);
        open[l] = {};
      }
      if (end) continue;
      const auto child = static_cast<std::uint32_t>(codes[i] >> 3 * l & 7);
      open[l].set_until(child, i);
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

// ---- Queries ----

// nanoflann's k-d tree takes 2.6 to 3.5 times as long for the PCA classifier (79,000 voxels, one
// core of an AMD EPYC, rival_classifiers.hpp).

namespace {

constexpr std::int32_t kCells = 1 << kZBits;

/// A query in units of level-0 cells, clamped to the frame's cube.
struct Place {
  Vec3d at;
  ZCell cell;          // at level 0
  double gap_squared;  // squared clamping distance

  Place(const ZFrame& frame, const Vec3f& p);
  ZCell cell_at(int level) const { return {cell[0] >> level, cell[1] >> level, cell[2] >> level}; }
  /// Squared distance within which no point is outside the surrounding 3x3x3 cells, as a limit on
  /// float distances: those of farther points always round to more. `cell_m2`: squared edge.
  float limit(int level, double cell_m2) const;
};

/// The candidates around the most recent query cells of one thread, at every level. Queries follow
/// the curve, so most of them reuse the cached cells.
class Surroundings {
 public:
  /// `k`: coincident points beyond this many may be dropped. The index must outlive this object.
  Surroundings(const CellIndex& index, std::size_t k) : index_(index), k_(k) {}

  /// Level at which to begin: below the usual one where points are dense.
  int first_level(const Place& place);
  /// Points of the 3x3x3 cells around the query, valid until the next call.
  Candidates around(const Place& place, int level);
  /// Scratch space: one float per candidate.
  FloatGroup* scratch() { return scratch_.data(); }

 private:
  struct Range {
    std::uint32_t begin, end;
  };
  struct Block {
    ZCell center{-1, -1, -1};
    std::vector<Range> ranges;  // of points, ascending
    std::size_t size = 0;
    bool gathered = false;
    std::size_t groups = 0;
    std::vector<FloatGroup> x, y, z;
    std::vector<IndexGroup> index;
  };

  static void add(Block& block, Range range);
  Block& find(const Place& place, int level);
  void find_ranges(Block& block, int level) const;
  void leave_out_equals(Block& block) const;
  void gather(Block& block);

  const CellIndex& index_;
  std::size_t k_;
  std::array<Block, kZBits + 1> blocks_;
  std::vector<FloatGroup> scratch_;
};

Place::Place(const ZFrame& frame, const Vec3f& p) {
  const Vec3d q = frame.in_cells(p);
  at = q.cwiseMax(0.0).cwiseMin(kCells - 1.0);
  for (int axis = 0; axis < 3; ++axis) cell[axis] = static_cast<std::int32_t>(at[axis]);
  gap_squared = (q - at).squaredNorm();
}

float Place::limit(int level, double cell_m2) const {
  if (level == kZBits) return std::numeric_limits<float>::infinity();
  const double edge = 1 << level;
  double reach = 2 * edge;
  for (int axis = 0; axis < 3; ++axis) {
    const double into_cell = at[axis] - static_cast<double>(cell[axis] >> level << level);
    reach = std::min({reach, edge + into_cell, 2 * edge - into_cell});
  }
  // The points are inside the cube, so the angle at the clamped position is obtuse.
  const double squared_m2 = (reach * reach + gap_squared) * cell_m2 * (1 - 2e-5);
  constexpr double kUnderflow = 1e-30;  // squares below this lose precision
  constexpr double kLargest = std::numeric_limits<float>::max();
  return squared_m2 > kUnderflow ? static_cast<float>(std::min(squared_m2, kLargest)) : -1.f;
}

int Surroundings::first_level(const Place& place) {
  int level = index_.level;
  while (level > 0 && find(place, level).size > index_.crowd) --level;
  return level;
}

Candidates Surroundings::around(const Place& place, int level) {
  Block& block = find(place, level);
  if (!block.gathered) gather(block);
  return {block.x.data(), block.y.data(), block.z.data(), block.index.data(), block.groups};
}

Surroundings::Block& Surroundings::find(const Place& place, int level) {
  Block& block = blocks_[level];
  const ZCell center = place.cell_at(level);
  if (block.center == center) return block;
  block.center = center;
  block.gathered = false;
  block.size = 0;
  block.ranges.clear();
  if (level == kZBits)
    add(block, {0, static_cast<std::uint32_t>(index_.points.size())});
  else
    find_ranges(block, level);
  return block;
}

/// The 3x3x3 cells are contained in 2x2x2 cells of the next level.
void Surroundings::find_ranges(Block& block, int level) const {
  // Per axis, the lower half of eight siblings.
  constexpr std::array<std::uint8_t, 3> kLower{0x55, 0x33, 0x0f};
  struct Part {
    Siblings siblings;
    unsigned wanted;
  };
  std::array<Part, 8> parts;
  std::size_t count = 0;
  std::array<std::array<std::uint64_t, 2>, 3> code;  // by axis: lower and upper parent
  std::array<std::array<unsigned, 2>, 3> wanted;     // siblings needed from it
  for (int axis = 0; axis < 3; ++axis) {
    const std::int32_t c = block.center[axis], parents = kCells >> (level + 1);
    const bool odd = (c & 1) != 0;
    const std::int32_t lower = (c + 1) / 2 - 1, upper = lower + 1;
    code[axis] = {morton_spread(static_cast<std::uint64_t>(std::max(lower, 0))) << axis,
                  morton_spread(static_cast<std::uint64_t>(upper)) << axis};
    wanted[axis] = {odd ? 0xffU : 0xffU & ~kLower[axis], odd ? kLower[axis] : 0xffU};
    if (lower < 0) wanted[axis][0] = 0;
    if (upper >= parents) wanted[axis][1] = 0;
  }
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) {
        const unsigned mask = wanted[0][x] & wanted[1][y] & wanted[2][z];
        if (mask == 0) continue;
        Part part{index_.cells.find(index_.z.codes, code[0][x] | code[1][y] | code[2][z], level),
                  mask};
        part.wanted &= part.siblings.occupied;
        if (part.wanted == 0) continue;
        std::size_t at = count++;
        for (; at > 0 && parts[at - 1].siblings.begin[0] > part.siblings.begin[0]; --at)
          parts[at] = parts[at - 1];
        parts[at] = part;
      }
  for (std::size_t i = 0; i < count; ++i)
    for (unsigned rest = parts[i].wanted; rest != 0; rest &= rest - 1) {
      const int cell = std::countr_zero(rest);
      add(block, {parts[i].siblings.begin[cell], parts[i].siblings.begin[cell + 1]});
    }
}

void Surroundings::add(Block& block, Range range) {
  block.size += range.end - range.begin;
  if (!block.ranges.empty() && block.ranges.back().end == range.begin)
    block.ranges.back().end = range.end;
  else
    block.ranges.push_back(range);
}

void Surroundings::gather(Block& block) {
  block.gathered = true;
  if (block.size > index_.crowd) leave_out_equals(block);
  block.groups = (block.size + kGroup - 1) / kGroup;
  if (block.x.size() < block.groups + 1) {  // one extra group, because copies are made in
                                            // whole groups
    for (auto* lanes : {&block.x, &block.y, &block.z}) lanes->resize(block.groups + 1);
    block.index.resize(block.groups + 1);
  }
  if (scratch_.size() < block.groups) scratch_.resize(block.groups);
  float *x = block.x[0].lane, *y = block.y[0].lane, *z = block.z[0].lane;
  std::uint32_t* index = block.index[0].lane;
  std::size_t to = 0;
  for (const Range& range : block.ranges) {
    for (std::uint32_t from = range.begin; from < range.end; from += kGroup) {
      const std::size_t at = to + (from - range.begin);
      std::memcpy(x + at, index_.axes[0].data() + from, sizeof(FloatGroup));
      std::memcpy(y + at, index_.axes[1].data() + from, sizeof(FloatGroup));
      std::memcpy(z + at, index_.axes[2].data() + from, sizeof(FloatGroup));
      for (std::uint32_t i = 0; i < kGroup; ++i) index[at + i] = from + i;
    }
    to += range.end - range.begin;
  }
  std::fill(x + block.size, x + block.groups * kGroup, std::numeric_limits<float>::quiet_NaN());
}

/// Coincident points are consecutive; only the first k of them can be neighbors.
void Surroundings::leave_out_equals(Block& block) const {
  const std::vector<Range> ranges = std::move(block.ranges);
  block.ranges.clear();
  block.size = 0;
  for (const Range& range : ranges)
    for (std::uint32_t i = range.begin; i < range.end; ++i)
      if (i < k_ || index_.points[i] != index_.points[i - k_]) add(block, {i, i + 1});
}

/// On a surface, the k nearest neighbors fill a disc; at this density the disc fits into 3x3 cells.
double points_per_cell(int k) { return std::max(1.0, k / 3.5); }

double cell_m2(const ZFrame& frame) { return 1 / frame.cells_per_m / frame.cells_per_m; }

}  // namespace

NeighborGrid::NeighborGrid(std::span<const Vec3f> points, int k) : k_(k) {
  assert(std::all_of(points.begin(), points.end(), [](const Vec3f& p) { return p.allFinite(); }));
  index_.z = z_order(points, points_per_cell(k));
  index_.points.reserve(points.size());
  for (const std::uint32_t i : index_.z.order) index_.points.push_back(points[i]);
  make_cells();
}

NeighborGrid NeighborGrid::every(int rate) const {
  assert(rate > 0);
  NeighborGrid coarse;
  coarse.k_ = k_;
  coarse.index_.z.frame = index_.z.frame;
  for (std::size_t i = 0; i < size(); i += static_cast<std::size_t>(rate)) {
    coarse.index_.points.push_back(index_.points[i]);
    coarse.index_.z.codes.push_back(index_.z.codes[i]);
    coarse.index_.z.order.push_back(index_.z.order[i]);
  }
  coarse.make_cells();
  return coarse;
}

void NeighborGrid::make_cells() {
  for (int axis = 0; axis < 3; ++axis) {
    index_.axes[axis].resize(size() + kGroup);
    for (std::size_t i = 0; i < size(); ++i) index_.axes[axis][i] = index_.points[i][axis];
  }
  index_.crowd = 64 + 16 * static_cast<std::size_t>(k_);
  index_.level = z_level(index_.z.codes, points_per_cell(k_));
  index_.cells = CellTable(index_.z.codes, index_.level);
}

void NeighborGrid::nearest(int k, std::size_t begin, std::size_t end, std::uint32_t* rows) const {
  assert(k >= 0 && begin <= end && end <= size());
  if (k == 0 || begin == end) return;
  const double edge_squared = cell_m2(index_.z.frame);
  const auto width = static_cast<std::size_t>(k), wanted = std::min(width, size());
  Surroundings surroundings(index_, wanted);
  std::vector<std::uint32_t> row(wanted + kGroup);
  for (std::size_t i = begin; i < end; ++i, rows += width) {
    const Vec3f& p = index_.points[i];
    if (i == begin || p != index_.points[i - 1]) {
      const Place place(index_.z.frame, p);
      for (int level = surroundings.first_level(place);; ++level) {
        const Candidates candidates = surroundings.around(place, level);
        if (nearest_candidates(candidates, p.data(), wanted, place.limit(level, edge_squared),
                               surroundings.scratch(), row.data()))
          break;
      }
    }
    std::copy_n(row.begin(), wanted, rows);
    std::fill(rows + wanted, rows + width, kNoNeighbor);
  }
}

void NeighborGrid::nearest_to(std::span<const Vec3f> queries, std::uint32_t* found) const {
  const double edge_squared = cell_m2(index_.z.frame);
  Surroundings surroundings(index_, 1);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    found[i] = kNoNeighbor;
    if (index_.points.empty()) continue;
    const Vec3f& q = queries[i];
    const Place place(index_.z.frame, q);
    for (int level = surroundings.first_level(place);; ++level) {
      const Candidates candidates = surroundings.around(place, level);
      if (candidates.groups > 0 &&
          nearest_candidate(candidates, q.data(), &found[i]) <= place.limit(level, edge_squared))
        break;
    }
  }
}

}  // namespace planescope::planes
