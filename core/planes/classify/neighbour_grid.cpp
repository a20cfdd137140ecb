// A query looks at the 3x3x3 cells around its own, at the level whose cells hold about the right
// number of points, and one level up for as long as its k-th neighbour could still lie outside.

#include "core/planes/classify/neighbour_grid.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "core/model/morton.hpp"
#include "core/planes/classify/cell_table.hpp"
#include "core/planes/classify/neighbour_kernels.hpp"

namespace planescope::planes {
namespace {

constexpr std::int32_t kCells = 1 << kZBits;

/// A query in units of level-0 cells, moved into the frame's cube if it lies outside.
struct Place {
  Vec3d at;
  ZCell cell;          // at level 0
  double gap_squared;  // by how much it was moved

  Place(const ZFrame& frame, const Vec3f& p);
  ZCell cell_at(int level) const { return {cell[0] >> level, cell[1] >> level, cell[2] >> level}; }
  /// The squared distance within which no point lies outside the 3x3x3 cells around, as the limit
  /// of float distances: those of farther points surely round to more. `cell_m2`: edge squared.
  float limit(int level, double cell_m2) const;
};

/// The candidates around the cells that the last queries of one thread lay in, at every level:
/// queries come along the curve, so that most find theirs here.
class Surroundings {
 public:
  /// `k`: equal points beyond so many may be left out. The index must outlive this.
  Surroundings(const CellIndex& index, std::size_t k) : index_(index), k_(k) {}

  /// The level to begin at: below the usual one where points crowd.
  int first_level(const Place& place);
  /// The points of the 3x3x3 cells around the place's, until the next call.
  Candidates around(const Place& place, int level);
  /// Room for a float for each of them.
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
  // Points lie in the cube, so that the angle at the place moved to is obtuse.
  const double squared_m2 = (reach * reach + gap_squared) * cell_m2 * (1 - 2e-5);
  constexpr double kUnderflow = 1e-30;  // squares below have fewer digits
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

/// The 3x3x3 cells lie in 2x2x2 cells of the level above.
void Surroundings::find_ranges(Block& block, int level) const {
  constexpr std::array<std::uint8_t, 3> kLower{0x55, 0x33, 0x0f};  // of eight siblings, by axis
  struct Part {
    Siblings siblings;
    unsigned wanted;
  };
  std::array<Part, 8> parts;
  std::size_t count = 0;
  std::array<std::array<std::uint64_t, 2>, 3> code;  // by axis, of the lower and the upper parent
  std::array<std::array<unsigned, 2>, 3> wanted;     // siblings in it
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
  if (block.x.size() < block.groups + 1) {  // a group more, for copies go by groups
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

/// Of equal points, which lie in a run, only the first k can be anybody's neighbours.
void Surroundings::leave_out_equals(Block& block) const {
  const std::vector<Range> ranges = std::move(block.ranges);
  block.ranges.clear();
  block.size = 0;
  for (const Range& range : ranges)
    for (std::uint32_t i = range.begin; i < range.end; ++i)
      if (i < k_ || index_.points[i] != index_.points[i - k_]) add(block, {i, i + 1});
}

/// On a surface the k nearest fill a disc; such a share of them in a cell lets 3x3 cells hold it.
double points_per_cell(int k) { return std::max(1.0, k / 3.5); }

double cell_m2(const ZFrame& frame) { return 1 / frame.cells_per_m / frame.cells_per_m; }

}  // namespace

NeighbourGrid::NeighbourGrid(std::span<const Vec3f> points, int k, Simd simd) : k_(k), simd_(simd) {
  assert(std::all_of(points.begin(), points.end(), [](const Vec3f& p) { return p.allFinite(); }));
  index_.z = z_order(points, points_per_cell(k));
  index_.points.reserve(points.size());
  for (const std::uint32_t i : index_.z.order) index_.points.push_back(points[i]);
  make_cells();
}

NeighbourGrid NeighbourGrid::every(int rate) const {
  assert(rate > 0);
  NeighbourGrid coarse;
  coarse.k_ = k_;
  coarse.simd_ = simd_;
  coarse.index_.z.frame = index_.z.frame;
  for (std::size_t i = 0; i < size(); i += static_cast<std::size_t>(rate)) {
    coarse.index_.points.push_back(index_.points[i]);
    coarse.index_.z.codes.push_back(index_.z.codes[i]);
    coarse.index_.z.order.push_back(index_.z.order[i]);
  }
  coarse.make_cells();
  return coarse;
}

void NeighbourGrid::make_cells() {
  for (int axis = 0; axis < 3; ++axis) {
    index_.axes[axis].resize(size() + kGroup);
    for (std::size_t i = 0; i < size(); ++i) index_.axes[axis][i] = index_.points[i][axis];
  }
  index_.crowd = 64 + 16 * static_cast<std::size_t>(k_);
  index_.level = z_level(index_.z.codes, points_per_cell(k_));
  index_.cells = CellTable(index_.z.codes, index_.level);
}

void NeighbourGrid::nearest(int k, std::size_t begin, std::size_t end, std::uint32_t* rows) const {
  assert(k >= 0 && begin <= end && end <= size());
  if (k == 0 || begin == end) return;
  const auto& kernels = neighbour_kernels(simd_);
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
        if (kernels.nearest(candidates, p.data(), wanted, place.limit(level, edge_squared),
                            surroundings.scratch(), row.data()))
          break;
      }
    }
    std::copy_n(row.begin(), wanted, rows);
    std::fill(rows + wanted, rows + width, kNoNeighbour);
  }
}

void NeighbourGrid::nearest_to(std::span<const Vec3f> queries, std::uint32_t* found) const {
  const auto& kernels = neighbour_kernels(simd_);
  const double edge_squared = cell_m2(index_.z.frame);
  Surroundings surroundings(index_, 1);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    found[i] = kNoNeighbour;
    if (index_.points.empty()) continue;
    const Vec3f& q = queries[i];
    const Place place(index_.z.frame, q);
    for (int level = surroundings.first_level(place);; ++level) {
      const Candidates candidates = surroundings.around(place, level);
      if (candidates.groups > 0 &&
          kernels.nearest_one(candidates, q.data(), &found[i]) <= place.limit(level, edge_squared))
        break;
    }
  }
}

const NeighbourKernels& neighbour_kernels(Simd simd) {
#if defined(__x86_64__)
  if (simd == Simd::avx512) return kNeighbourKernelsAvx512;
  if (simd == Simd::avx2) return kNeighbourKernelsAvx2;
#endif
  (void)simd;
  return kNeighbourKernelsPlain;
}

}  // namespace planescope::planes
