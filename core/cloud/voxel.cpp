// Sun et al. 2023, Sec. II-B: voxel downsampling. A flat open-addressing hash; neighbouring pixels
// mostly fall into the same voxel, so the voxel of the point before is tried first.

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "core/base/error.hpp"
#include "core/cloud/cloud.hpp"

namespace planescope {
namespace {

constexpr std::uint64_t kEmpty = ~0ull;
constexpr int kBitsPerAxis = 21;

/// Voxel key -> voxel number, in order of first appearance. Grows by doubling.
class VoxelTable {
 public:
  VoxelTable() : slots_(std::size_t{1} << kFirstBits, Slot{kEmpty, 0}) {}

  std::uint32_t find_or_add(std::uint64_t key) {
    std::size_t i = home(key);
    while (slots_[i].key != kEmpty) {
      if (slots_[i].key == key) return slots_[i].voxel;
      i = (i + 1) & (slots_.size() - 1);
    }
    slots_[i] = {key, size_};
    if (2 * (size_ + std::size_t{1}) > slots_.size()) grow();
    return size_++;
  }

 private:
  struct Slot {
    std::uint64_t key;
    std::uint32_t voxel;
  };
  static constexpr int kFirstBits = 15;

  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ull) >> shift_);  // Fibonacci hashing
  }
  void grow() {
    std::vector<Slot> old(slots_.size() * 2, Slot{kEmpty, 0});
    old.swap(slots_);
    --shift_;
    for (const Slot& slot : old) {
      if (slot.key == kEmpty) continue;
      std::size_t i = home(slot.key);
      while (slots_[i].key != kEmpty) i = (i + 1) & (slots_.size() - 1);
      slots_[i] = slot;
    }
  }

  std::vector<Slot> slots_;
  int shift_ = 64 - kFirstBits;
  std::uint32_t size_ = 0;
};

/// Sums of a voxel's points. A float's 24 bits leave a double room for 2^29 of them before anything
/// is rounded, so the mean does not depend on the order of the points.
struct Sum {
  double x = 0, y = 0, z = 0;
  std::uint32_t count = 0;
};

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
                ", expected 0 (no voxel grid) or a size in metres");
  if (voxel_size_m == 0) return every_point_its_own(cloud);
  if (cloud.cube.edge_m / voxel_size_m >= (1 << kBitsPerAxis) - 1)
    throw Error("voxel_size_m is " + std::to_string(voxel_size_m) + ", too small for a cube of " +
                std::to_string(cloud.cube.edge_m) + " m: expected at least " +
                std::to_string(cloud.cube.edge_m / (1 << (kBitsPerAxis - 1))));

  VoxelCloud result;
  result.voxel_of.assign(cloud.points.size(), kNoVoxel);
  VoxelTable table;
  std::vector<Sum> sums;
  const double per_voxel = 1 / voxel_size_m;
  const Vec3d corner = cloud.cube.min_corner;
  std::uint64_t current_key = kEmpty;
  std::uint32_t current = 0;
  Sum run;  // of the voxel at hand, added to `sums` when the next one begins
  const auto flush = [&] {
    if (run.count == 0) return;
    if (current == sums.size()) sums.emplace_back();
    Sum& sum = sums[current];
    sum.x += run.x;
    sum.y += run.y;
    sum.z += run.z;
    sum.count += run.count;
    run = Sum{};
  };
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.kept[i]) continue;
    const double x = cloud.points[i].x(), y = cloud.points[i].y(), z = cloud.points[i].z();
    // Kept points lie in the cube: offsets are not negative, so truncation is floor.
    const auto ix =
        static_cast<std::uint64_t>(static_cast<std::int64_t>((x - corner.x()) * per_voxel));
    const auto iy =
        static_cast<std::uint64_t>(static_cast<std::int64_t>((y - corner.y()) * per_voxel));
    const auto iz =
        static_cast<std::uint64_t>(static_cast<std::int64_t>((z - corner.z()) * per_voxel));
    const std::uint64_t key = (iz << (2 * kBitsPerAxis)) | (iy << kBitsPerAxis) | ix;
    if (key != current_key) {
      flush();
      current_key = key;
      current = table.find_or_add(key);
    }
    run.x += x;
    run.y += y;
    run.z += z;
    ++run.count;
    result.voxel_of[i] = current;
  }
  flush();

  result.points.reserve(sums.size());
  result.count.reserve(sums.size());
  for (const Sum& sum : sums) {
    const double n = sum.count;
    result.points.emplace_back(static_cast<float>(sum.x / n), static_cast<float>(sum.y / n),
                               static_cast<float>(sum.z / n));
    result.count.push_back(sum.count);
  }
  return result;
}

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
      if (end - run > best) {  // ascending values: the first of equals is the smaller
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

}  // namespace planescope
