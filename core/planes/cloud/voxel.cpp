// Sun et al. 2023, Sec. II-B: voxel downsampling with a flat open-addressing hash. Neighboring
// pixels mostly share a voxel, so runs of points are looked up instead of single points. Run ends
// are unpredictable, so all work per point and per run is branch-free.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include "core/model/error.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "core/planes/cloud/key_numbers.hpp"

namespace planescope::planes {
namespace {

constexpr int kBitsPerAxis = 21;
constexpr std::size_t kBlock = 128;  // points per batch; all scratch fits into the L1 cache

// Four lanes in one register (GCC and Clang, any processor): x, y, z and a spare lane.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Uint4 = std::uint32_t __attribute__((vector_size(16)));
using Ulong2 = std::uint64_t __attribute__((vector_size(16)));

/// Grid position as fixed-point numbers: cell << fraction_bits | offset in the cell.
struct Grid {
  Vec3f corner = Vec3f::Zero();
  double voxel_size_m = 0;
  int fraction_bits = 0;

  /// Reads the point at `p` and the following float (which must be finite); the spare lane
  /// becomes 0.
  Uint4 fixed(const float* p) const {
    const auto scale = static_cast<float>((1 << fraction_bits) / voxel_size_m);
    Float4 point;
    std::memcpy(&point, p, sizeof point);
    const Float4 offset = point - Float4{corner.x(), corner.y(), corner.z(), 0};
    return (Uint4) __builtin_convertvector(offset * Float4{scale, scale, scale, 0}, Int4);
  }
  static std::uint64_t key(const Uint4& cell) {
    return std::uint64_t{cell[2]} << (2 * kBitsPerAxis) | std::uint64_t{cell[1]} << kBitsPerAxis |
           cell[0];
  }
};

Grid make_grid(const Cube& cube, double voxel_size_m) {
  Grid grid;
  grid.voxel_size_m = voxel_size_m;
  // Rounded down, so that no point of the cube falls below the corner.
  for (int axis = 0; axis < 3; ++axis) {
    const double corner = cube.min_corner[axis];
    const auto rounded = static_cast<float>(corner);
    grid.corner[axis] =
        rounded <= corner ? rounded : std::nextafter(rounded, -std::numeric_limits<float>::max());
  }
  const auto cells = static_cast<std::uint32_t>(cube.edge_m / voxel_size_m) + 1;
  // A block's sum of fractions must stay below 2^32, and a cell with its fraction below 2^31.
  grid.fraction_bits = std::min(24, 31 - static_cast<int>(std::bit_width(cells)));
  return grid;
}

/// Accumulates the fractional offsets of a voxel's points. Integer sums, so that the mean does not
/// depend on the order of the points.
struct Voxel {
  std::uint64_t x = 0, y = 0, z = 0;
  std::uint32_t count = 0;

  void operator+=(const Uint4& sums) {
    x += sums[0];
    y += sums[1];
    z += sums[2];
    count += sums[3];
  }
};

/// Voxels by key, in order of first appearance.
class VoxelTable {
 public:
  VoxelTable() { voxels_.reserve(kExpected); }

  std::uint32_t find_or_add(std::uint64_t key) {
    const std::uint32_t number = numbers_.find_or_add(key);
    if (number == voxels_.size()) voxels_.emplace_back();
    return number;
  }
  void fetch(std::uint64_t key) const { numbers_.fetch(key); }
  Voxel& operator[](std::uint32_t number) { return voxels_[number]; }
  const std::vector<std::uint64_t>& keys() const { return numbers_.keys(); }
  const std::vector<Voxel>& voxels() const { return voxels_; }

 private:
  static constexpr std::size_t kExpected = (1 << 15) - 1;  // more than in most frames
  KeyNumbers numbers_{kExpected};
  std::vector<Voxel> voxels_;
};

/// Up to kBlock points and the starts of their runs.
struct Block {
  float points[3 * kBlock + 1] = {};         // one extra: the last point is read as four floats
  Uint4 before[kBlock + 1] = {};             // per run: sums of fractions and number of points
                                             // before it
  std::uint32_t voxel_of[kBlock + 16] = {};  // runs are written sixteen entries at a time
  std::uint64_t keys[kBlock] = {};           // per run
  std::uint32_t voxels[kBlock] = {};
  std::size_t runs = 0;
};

/// Prefetches memory that will be read soon. The hardware prefetcher stops at page boundaries, and
/// a frame takes megabytes: without this, half of the time is spent waiting.
void fetch(const Vec3f* begin, const Vec3f* end) {
  constexpr std::size_t kLine = 64 / sizeof(float);
  if (begin >= end) return;
  for (const float* p = begin->data(); p < end[-1].data(); p += kLine) __builtin_prefetch(p);
}

/// Fills `block` with consecutive points. A point extends the current run if it is in the same
/// voxel as the previous point.
void find_runs(const Grid& grid, const Vec3f* points, std::size_t count, Block& block) {
  std::memcpy(block.points, points->data(), count * sizeof(Vec3f));
  const Uint4 fraction = Uint4{} + ((1u << grid.fraction_bits) - 1);
  Uint4 sum{};
  Ulong2 last = Ulong2{} - 1;
  std::size_t runs = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Uint4 fixed = grid.fixed(block.points + 3 * i);
    const auto cell = (Ulong2)(fixed >> grid.fraction_bits);
    block.before[runs] = sum;  // overwritten unless a run begins here
    sum += (fixed & fraction) + Uint4{0, 0, 0, 1};
    const Ulong2 change = cell ^ last;
    runs += (change[0] | change[1]) != 0;
    last = cell;
  }
  block.before[runs] = sum;
  block.runs = runs;
}

/// Adds the block's runs to their voxels, and records the voxel of each point. One small loop per
/// task, so that the processor overlaps many runs.
void add_runs(const Grid& grid, Block& block, VoxelTable& table) {
  for (std::size_t run = 0; run < block.runs; ++run) {
    const float* first_point = block.points + 3 * block.before[run][3];
    block.keys[run] = Grid::key(grid.fixed(first_point) >> grid.fraction_bits);
    table.fetch(block.keys[run]);
  }
  for (std::size_t run = 0; run < block.runs; ++run)
    block.voxels[run] = table.find_or_add(block.keys[run]);
  for (std::size_t run = 0; run < block.runs; ++run)
    table[block.voxels[run]] += block.before[run + 1] - block.before[run];
  constexpr std::size_t kAtOnce = 16;
  for (std::size_t run = 0; run < block.runs; ++run) {
    // Entries written past the end are overwritten by the following runs.
    const std::uint32_t end = block.before[run + 1][3];
    for (std::uint32_t i = block.before[run][3]; i < end; i += kAtOnce)
      std::fill_n(block.voxel_of + i, kAtOnce, block.voxels[run]);
  }
}

/// Computes the voxels' means and counts.
void finish(const Grid& grid, const VoxelTable& table, VoxelCloud& result) {
  constexpr std::uint64_t kMask = (1u << kBitsPerAxis) - 1;
  const double fraction_m = grid.voxel_size_m / (1 << grid.fraction_bits);
  const std::size_t count = table.voxels().size();
  result.points.resize(count);
  result.count.resize(count);
  for (std::size_t v = 0; v < count; ++v) {
    const std::uint64_t key = table.keys()[v];
    const Voxel& voxel = table.voxels()[v];
    const double share_m = fraction_m / voxel.count;
    const auto at = [&](float corner, std::uint64_t cell, std::uint64_t sum) {
      return static_cast<float>(corner + static_cast<double>(cell) * grid.voxel_size_m +
                                static_cast<double>(sum) * share_m);
    };
    result.points[v] = {at(grid.corner.x(), key & kMask, voxel.x),
                        at(grid.corner.y(), key >> kBitsPerAxis & kMask, voxel.y),
                        at(grid.corner.z(), key >> 2 * kBitsPerAxis, voxel.z)};
    result.count[v] = voxel.count;
  }
}

/// Index of the first byte with this value in [begin, end), or end.
std::size_t find_byte(const std::vector<std::uint8_t>& bytes,
                      std::uint8_t value,
                      std::size_t begin,
                      std::size_t end) {
  if (begin >= end) return end;
  const void* found = std::memchr(bytes.data() + begin, value, end - begin);
  return found == nullptr
             ? end
             : static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - bytes.data());
}

VoxelCloud every_point_its_own(const Cloud& cloud) {
  VoxelCloud result;
  result.voxel_of.assign(cloud.points.size(), kNoVoxel);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.kept[i]) continue;
    result.voxel_of[i] = static_cast<std::uint32_t>(result.points.size());
    result.points.push_back(cloud.points[i]);
  }
  result.count.assign(result.points.size(), 1);
  return result;
}

}  // namespace

VoxelCloud voxelize(const Cloud& cloud, double voxel_size_m) {
  if (!(voxel_size_m >= 0) || !std::isfinite(voxel_size_m))
    throw Error("voxel_size_m is " + std::to_string(voxel_size_m) +
                "; expected 0 (no voxel grid) or a size in meters");
  if (voxel_size_m == 0) return every_point_its_own(cloud);
  if (cloud.cube.edge_m / voxel_size_m >= (1 << kBitsPerAxis) - 1)
    throw Error("voxel_size_m is " + std::to_string(voxel_size_m) + ", too small for a " +
                std::to_string(cloud.cube.edge_m) + " m cube; expected at least " +
                std::to_string(cloud.cube.edge_m / (1 << (kBitsPerAxis - 1))));

  const Grid grid = make_grid(cloud.cube, voxel_size_m);
  VoxelCloud result;
  result.size_m = voxel_size_m;
  VoxelTable table;
  const auto block = std::make_unique<Block>();
  const Vec3f* points = cloud.points.data();
  const std::size_t count = cloud.points.size();
  result.voxel_of.reserve(count);
  // Cropped points are clustered: process the kept ones range by range, block by block.
  for (std::size_t next = 0; next < count;) {
    const std::size_t begin = find_byte(cloud.kept, 1, next, count);
    const std::size_t end = find_byte(cloud.kept, 0, begin, std::min(begin + kBlock, count));
    fetch(points + end, points + std::min(end + kBlock, count));
    find_runs(grid, points + begin, end - begin, *block);
    add_runs(grid, *block, table);
    result.voxel_of.resize(begin, kNoVoxel);
    result.voxel_of.insert(result.voxel_of.end(), block->voxel_of, block->voxel_of + (end - begin));
    next = end;
  }
  finish(grid, table, result);
  return result;
}

// Points of each voxel, and votes of their values.

VoxelMembers voxel_members(const VoxelCloud& voxels) {
  VoxelMembers result;
  result.first.assign(voxels.points.size() + 1, 0);
  for (std::size_t v = 0; v < voxels.count.size(); ++v)
    result.first[v + 1] = result.first[v] + voxels.count[v];
  result.members.resize(result.first.back());
  std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
  for (std::size_t i = 0; i < voxels.voxel_of.size(); ++i)
    if (const std::uint32_t v = voxels.voxel_of[i]; v != kNoVoxel)
      result.members[next[v]++] = static_cast<std::uint32_t>(i);
  return result;
}

namespace {

template <typename T>
std::vector<T> majority(const VoxelCloud& voxels, std::span<const T> values) {
  const VoxelMembers csr = voxel_members(voxels);
  std::vector<T> result(voxels.points.size(), T{0});
  std::vector<T> votes;
  for (std::size_t v = 0; v < result.size(); ++v) {
    votes.clear();
    for (std::uint32_t m = csr.first[v]; m < csr.first[v + 1]; ++m)
      if (const T value = values[csr.members[m]]; value != 0) votes.push_back(value);
    std::sort(votes.begin(), votes.end());
    std::ptrdiff_t best = 0;
    for (auto run = votes.begin(); run != votes.end();) {
      const auto end = std::upper_bound(run, votes.end(), *run);
      if (end - run > best) {  // ascending values: ties go to the smaller
        best = end - run;
        result[v] = *run;
      }
      run = end;
    }
  }
  return result;
}

}  // namespace

std::vector<std::uint8_t> vote_labels(const VoxelCloud& voxels,
                                      std::span<const std::uint8_t> labels) {
  return majority(voxels, labels);
}

std::vector<std::int32_t> vote_instances(const VoxelCloud& voxels,
                                         std::span<const std::int32_t> ids) {
  return majority(voxels, ids);
}

}  // namespace planescope::planes
