#include "core/lab/bench/floors.hpp"

#include <gtest/gtest.h>

namespace planescope::lab {
namespace {

TEST(Floors, AreTheLargerOfTheTimesOfBytesAndSums) {
  const Peaks peaks{.bytes_per_s = 1e9, .flops_per_s = 1e10};
  const Floor moved = floor_of({.bytes = 2e6, .flops = 1e6}, peaks);
  EXPECT_DOUBLE_EQ(moved.ms, 2);
  EXPECT_TRUE(moved.by_bytes);
  const Floor summed = floor_of({.bytes = 2e6, .flops = 5e7}, peaks);
  EXPECT_DOUBLE_EQ(summed.ms, 5);
  EXPECT_FALSE(summed.by_bytes);
}

TEST(Floors, CountWhatGoesInAndWhatComesOut) {
  EXPECT_EQ(load_work(200, 300).bytes, 500);
  EXPECT_EQ(gravity_work(200).bytes, 200);
  EXPECT_EQ(cloud_work(200, 10).bytes, 200 + 17 * 10);
  EXPECT_EQ(cloud_work(200, 10).flops, 170);
  // 10 measured, of which 8 are kept in 3 voxels.
  EXPECT_EQ(voxel_work(10, 8, 3).bytes, 10 + 8 * 12 + 10 * 4 + 3 * 16);
  EXPECT_EQ(voxel_work(10, 8, 3).flops, 8 * 9 + 3 * 3);
  EXPECT_EQ(pca_work(10, 16).flops, 10 * 16 * 15);
  EXPECT_EQ(octree_work(10).bytes, 10 * (13 + 29));
  EXPECT_EQ(segment_work(10, 100, true).bytes - segment_work(10, 100, false).bytes, 1200);
}

TEST(Floors, OfANetworkAreItsMatricesAndItsKernels) {
  const planes::NetworkConfig network{.name = "tiny",
                                      .levels = {{2}, {3}},
                                      .supports = 1,
                                      .neighbours = 4,
                                      .pool_rate = 4,
                                      .pool_neighbours = 4,
                                      .global_feature = false,
                                      .head = {5}};
  const double n = 40, pooled = 10;
  const double surface = n * 4 * 2 * 5, head_of_first = 2 * n * 2 * 5;
  const double convolution = 2 * pooled * 2 * (2 * 3) + pooled * 4 * 3 * 6;
  const double head_of_second = 2 * pooled * 3 * 5, logits = 2 * n * 5 * 2;
  EXPECT_EQ(gcn_work(40, network).flops,
            surface + head_of_first + convolution + head_of_second + logits);
}

TEST(Floors, ThisMachineMovesBytesAndSumsNumbers) {
  const Peaks peaks = measure_peaks();
  EXPECT_GT(peaks.bytes_per_s, 0);
  EXPECT_GT(peaks.flops_per_s, 0);
}

}  // namespace
}  // namespace planescope::lab
