// Tests of voxels: cells, means, members and majority labels.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>

#include "core/model/error.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::planes {
namespace {

/// Points on a lattice at least half a millimeter from every cell border, so that rounding does not
/// change their cell.
Cloud random_cloud(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> at(0, 3199);
  Cloud cloud;
  cloud.cube.min_corner = Vec3d::Constant(-1.6);
  Eigen::Vector3i lattice(0, 0, 0);
  for (int i = 0; i < count; ++i) {
    // Sequences of near points, as in an image, and isolated ones.
    lattice = i % 7 == 0 ? Eigen::Vector3i(at(random), at(random), at(random))
                         : Eigen::Vector3i(lattice + Eigen::Vector3i(4, 0, 1));
    lattice = lattice.cwiseMin(3199);
    const Vec3d p = (lattice.cast<double>().array() + 0.5) * 1e-3 - 1.6;
    cloud.points.push_back(p.cast<float>());
    cloud.kept.push_back(random() % 10 != 0);
    cloud.source.push_back(static_cast<std::uint32_t>(i));
  }
  return cloud;
}

TEST(Voxels, MatchAPlainMapOfCells) {  // 300000 points, so that the hash table grows
  for (const double size_m : {0.02, 0.05, 0.4, 5.0}) {
    const Cloud cloud = random_cloud(7, 300000);
    struct Reference {
      Vec3d sum = Vec3d::Zero();
      std::uint32_t count = 0, first = 0;
    };
    std::map<std::array<long, 3>, Reference> cells;
    for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
      if (!cloud.kept[i]) continue;
      const Vec3d offset = (cloud.points[i].cast<double>() - cloud.cube.min_corner) * (1 / size_m);
      Reference& cell =
          cells[{std::lround(std::floor(offset.x())), std::lround(std::floor(offset.y())),
                 std::lround(std::floor(offset.z()))}];
      if (cell.count++ == 0) cell.first = i;
      cell.sum += cloud.points[i].cast<double>();
    }
    const VoxelCloud voxels = voxelize(cloud, size_m);
    ASSERT_EQ(voxels.points.size(), cells.size());
    std::map<std::uint32_t, Reference> by_first;
    for (const auto& [key, cell] : cells) by_first[cell.first] = cell;
    std::uint32_t v = 0;
    for (const auto& [first, cell] : by_first) {  // in order of first appearance
      EXPECT_EQ(voxels.voxel_of[first], v);
      EXPECT_EQ(voxels.count[v], cell.count);
      EXPECT_LT((voxels.points[v].cast<double>() - cell.sum / cell.count).norm(), 1e-6);
      ++v;
    }
  }
}

TEST(Voxels, CroppedPointsHaveNone) {
  const Cloud cloud = random_cloud(8, 500);
  for (const double size_m : {0.02, 0.0}) {
    const VoxelCloud voxels = voxelize(cloud, size_m);
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      EXPECT_EQ(voxels.voxel_of[i] == kNoVoxel, cloud.kept[i] == 0);
  }
}

TEST(Voxels, SizeZeroKeepsEveryPoint) {
  const Cloud cloud = random_cloud(9, 300);
  const VoxelCloud voxels = voxelize(cloud, 0);
  std::size_t v = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.kept[i]) {
      EXPECT_EQ(voxels.points[v++], cloud.points[i]);
    }
  EXPECT_EQ(voxels.points.size(), v);
}

TEST(Voxels, TheMeanDoesNotDependOnTheOrderOfThePoints) {
  Cloud cloud = random_cloud(10, 3000);
  const VoxelCloud forward = voxelize(cloud, 0.5);
  Cloud backward = cloud;
  std::reverse(backward.points.begin(), backward.points.end());
  std::reverse(backward.kept.begin(), backward.kept.end());
  const VoxelCloud reversed = voxelize(backward, 0.5);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.kept[i]) continue;
    EXPECT_EQ(forward.points[forward.voxel_of[i]],
              reversed.points[reversed.voxel_of[cloud.points.size() - 1 - i]]);
  }
}

TEST(Voxels, MembersAreTheirPointsInOrder) {
  const Cloud cloud = random_cloud(11, 2000);
  const VoxelCloud voxels = voxelize(cloud, 0.1);
  const VoxelMembers csr = voxel_members(voxels);
  ASSERT_EQ(csr.first.size(), voxels.points.size() + 1);
  std::size_t seen = 0;
  for (std::uint32_t v = 0; v < voxels.points.size(); ++v) {
    EXPECT_EQ(csr.first[v + 1] - csr.first[v], voxels.count[v]);
    for (std::uint32_t m = csr.first[v]; m < csr.first[v + 1]; ++m, ++seen) {
      EXPECT_EQ(voxels.voxel_of[csr.members[m]], v);
      if (m > csr.first[v]) {
        EXPECT_LT(csr.members[m - 1], csr.members[m]);
      }
    }
  }
  EXPECT_EQ(seen, csr.members.size());
}

TEST(Voxels, LabelsAreTheMajorityOfKnownOnesAndTiesGoToTheSmaller) {
  Cloud cloud;
  cloud.cube.min_corner = Vec3d::Constant(-1.6);
  std::vector<std::uint8_t> labels;
  std::vector<std::int32_t> ids;
  const auto put = [&](float x, std::uint8_t label, std::int32_t id) {
    cloud.points.emplace_back(x, 0.f, 0.f);
    cloud.kept.push_back(1);
    labels.push_back(label);
    ids.push_back(id);
  };
  for (int i = 0; i < 5; ++i) put(0.01f, 0, 0);  // unknown labels are the majority but do not count
  put(0.01f, 2, 9);
  for (int i = 0; i < 3; ++i) put(0.21f, 2, 300);
  for (int i = 0; i < 3; ++i) put(0.21f, 1, -1);
  put(0.41f, 0, 0);
  const VoxelCloud voxels = voxelize(cloud, 0.1);
  EXPECT_EQ(vote_labels(voxels, labels), (std::vector<std::uint8_t>{2, 1, 0}));
  EXPECT_EQ(vote_instances(voxels, ids), (std::vector<std::int32_t>{9, -1, 0}));
}

TEST(Voxels, AWholeFrameMayBeInOneVoxel) {
  Cloud cloud;
  cloud.cube.min_corner = Vec3d::Constant(-1.6);
  Vec3d sum = Vec3d::Zero();
  for (int i = 0; i < 100000; ++i) {
    const Vec3d p(0.1 + 1e-6 * (i % 1000), -0.3, 0.7 + 1e-7 * i);
    cloud.points.push_back(p.cast<float>());
    cloud.kept.push_back(1);
    sum += p;
  }
  const VoxelCloud voxels = voxelize(cloud, 0.4);
  ASSERT_EQ(voxels.points.size(), 1u);
  EXPECT_EQ(voxels.count[0], 100000u);
  EXPECT_LT((voxels.points[0].cast<double>() - sum / 100000).norm(), 1e-6);
}

TEST(Voxels, DistantPointsOfALargeCloudStaySeparate) {
  Cloud cloud;
  cloud.cube.min_corner = Vec3d::Constant(-13107.2);
  cloud.cube.edge_m = 26214.4;
  for (const float x : {-13107.f, -1.f, 0.01f, 13107.f})
    for (const float y : {-13107.f, 0.01f, 13107.f})
      for (const float z : {-13107.f, 0.01f, 13107.f}) cloud.points.emplace_back(x, y, z);
  cloud.kept.assign(cloud.points.size(), 1);
  const VoxelCloud voxels = voxelize(cloud, 0.02);
  ASSERT_EQ(voxels.points.size(), cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    EXPECT_LT((voxels.points[i] - cloud.points[i]).norm(), 0.02f);
}

TEST(Voxels, ASizeBeyondTheKeysIsRejected) {
  Cloud cloud = random_cloud(12, 10);
  EXPECT_THROW(voxelize(cloud, 1e-7), Error);
  EXPECT_THROW(voxelize(cloud, -1), Error);
  EXPECT_THROW(voxelize(cloud, std::nan("")), Error);
}

}  // namespace
}  // namespace planescope::planes
