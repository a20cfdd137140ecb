// Which points a voxel holds, and what they say about it.

#include <algorithm>

#include "core/planes/cloud/cloud.hpp"

namespace planescope::planes {

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

}  // namespace planescope::planes
