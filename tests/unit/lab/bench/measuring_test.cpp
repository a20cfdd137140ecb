// Tests of benchmark timing: statistics, clocks, lower bounds and scaling.

#include "core/lab/bench/measuring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/lab/bench/floors.hpp"
#include "core/lab/bench/scaling.hpp"
#include "core/lab/synthetic/stairs.hpp"

namespace planescope::lab {
namespace {

TEST(Statistics, TheMedianIsTheMiddleOrTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median({7}), 7);
  EXPECT_EQ(median({9, 1, 5}), 5);
  EXPECT_EQ(median({4, 1, 100, 2}), 3);
  EXPECT_EQ(median({2, 2, 1, 2}), 2);
}

TEST(Statistics, OfSeveralRunsAreMedianMinimumAndMaximum) {
  const Times times = times_of({9, 1, 5});
  EXPECT_EQ(times.median, 5);
  EXPECT_EQ(times.least, 1);
  EXPECT_EQ(times.greatest, 9);
}

TEST(Statistics, RatiosAreComputedPerRound) {
  // Twice as long in every round, although the machine was slow in one of them.
  EXPECT_EQ(median_ratio(std::vector<double>{2, 20, 6}, std::vector<double>{1, 10, 3}), 2);
}

TEST(Clocks, MeasureWallThreadAndProcessTime) {
  for (const Clock clock : {Clock::wall, Clock::thread_cpu, Clock::process_cpu}) {
    bool ran = false;
    EXPECT_GE(spent_ms(clock, [&] { ran = true; }), 0) << to_string(clock);
    EXPECT_TRUE(ran);
  }
}

TEST(Interleaved, EveryRoundRunsEachContestantOnceAndTheFirstIsIgnored) {
  std::vector<int> runs(3), first_of_round;
  int turn = 0;
  const auto ms = interleaved_ms(
      3, 5, [] {},
      [&](std::size_t who, int) {
        ++runs[who];
        if (turn++ % 3 == 0) first_of_round.push_back(static_cast<int>(who));
      });
  EXPECT_EQ(runs, (std::vector{6, 6, 6}));
  EXPECT_EQ(first_of_round, (std::vector{0, 1, 2, 0, 1, 2}));
  ASSERT_EQ(ms.size(), 3u);
  for (const auto& of_one : ms) EXPECT_EQ(of_one.size(), 5u);
}

// ---- Lower bounds ----

TEST(Floors, AreTheLargerOfTheTimesOfBytesAndSums) {
  const Peaks peaks{.bytes_per_s = 1e9, .flops_per_s = 1e10};
  const Floor moved = floor_of({.bytes = 2e6, .flops = 1e6}, peaks);
  EXPECT_DOUBLE_EQ(moved.ms, 2);
  EXPECT_TRUE(moved.by_bytes);
  const Floor summed = floor_of({.bytes = 2e6, .flops = 5e7}, peaks);
  EXPECT_DOUBLE_EQ(summed.ms, 5);
  EXPECT_FALSE(summed.by_bytes);
}

TEST(Floors, CountInputsAndOutputs) {
  EXPECT_EQ(load_work(200, 300).bytes, 500);
  EXPECT_EQ(gravity_work(200).bytes, 200);
  EXPECT_EQ(cloud_work(200, 10).bytes, 200 + 17 * 10);
  EXPECT_EQ(cloud_work(200, 10).flops, 170);
  // 10 points measured, of which 8 are kept, in 3 voxels.
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
                                      .neighbors = 4,
                                      .pool_rate = 4,
                                      .pool_neighbors = 4,
                                      .global_feature = false,
                                      .head = {5}};
  const double n = 40, pooled = 10;
  const double surface = n * 4 * 2 * 5, head_of_first = 2 * n * 2 * 5;
  const double convolution = 2 * pooled * 2 * (2 * 3) + pooled * 4 * 3 * 6;
  const double head_of_second = 2 * pooled * 3 * 5, logits = 2 * n * 5 * 2;
  EXPECT_EQ(gcn_work(40, network).flops,
            surface + head_of_first + convolution + head_of_second + logits);
}

TEST(Floors, ThisMachineHasPositiveRates) {
  const Peaks peaks = measure_peaks();
  EXPECT_GT(peaks.bytes_per_s, 0);
  EXPECT_GT(peaks.flops_per_s, 0);
}

// ---- Scaling ----

TEST(Exponents, AreFittedToPowerLaws) {
  const std::vector<double> x = {1, 3, 10, 200};
  std::vector<double> y;
  for (const double value : x) y.push_back(7 * std::pow(value, 1.5));
  EXPECT_NEAR(fitted_exponent(x, y), 1.5, 1e-12);
  EXPECT_NEAR(fitted_exponent(x, std::vector<double>{4, 4, 4, 4}), 0, 1e-12);
  // One outlier above and another one below cancel.
  EXPECT_NEAR(fitted_exponent(std::vector<double>{1, 2, 4, 8}, std::vector<double>{1, 3, 3, 8}),
              0.9, 0.1);
}

TEST(Exponents, AreUndefinedForASingleX) {
  EXPECT_TRUE(std::isnan(fitted_exponent(std::vector<double>{2}, std::vector<double>{5})));
  EXPECT_TRUE(std::isnan(fitted_exponent(std::vector<double>{3, 3}, std::vector<double>{5, 6})));
}

TEST(ScaledFrames, ShowTheSameSceneAtAnotherResolution) {
  Frame frame;
  frame.depth = Image16(4, 2);
  for (std::size_t i = 0; i < frame.depth.data.size(); ++i)
    frame.depth.data[i] = static_cast<std::uint16_t>(100 + i);
  frame.intrinsics = {.width = 4, .height = 2, .fx = 3, .fy = 3, .cx = 1.5, .cy = 0.5};

  const Frame larger = scaled_frame(frame, 2);
  EXPECT_EQ(larger.depth.width, 8);
  EXPECT_EQ(larger.depth.height, 4);
  EXPECT_EQ(larger.depth.at(7, 3), frame.depth.at(3, 1));
  EXPECT_EQ(larger.depth.at(2, 0), frame.depth.at(1, 0));
  EXPECT_DOUBLE_EQ(larger.intrinsics.fx, 6);
  EXPECT_DOUBLE_EQ(larger.intrinsics.cx, 3.5) << "the middle stays the middle";

  const Frame smaller = scaled_frame(frame, 0.5);
  EXPECT_EQ(smaller.depth.width, 2);
  EXPECT_EQ(smaller.depth.height, 1);
  EXPECT_EQ(smaller.depth.at(1, 0), frame.depth.at(3, 1));
  EXPECT_DOUBLE_EQ(smaller.intrinsics.cx, 0.5);
}

TEST(Tiles, HaveTheRequestedNumberOfPointsOnSeparateLevels) {
  const PointsOnPlanes cloud = tiles(2, 500);
  EXPECT_EQ(cloud.points.size(), 500u);
  EXPECT_EQ(cloud.labels.size(), 500u);
  for (const Vec3f& p : cloud.points) {
    EXPECT_GE(p.head<2>().minCoeff(), 0);
    EXPECT_LE(p.head<2>().maxCoeff(), 5);
  }
}

TEST(Tiles, ScatteredStairsHaveTreadsAndRisers) {
  const PointsOnPlanes cloud = scattered_stairs(2000);
  EXPECT_EQ(cloud.points.size(), 2000u);
  EXPECT_GT(std::ranges::count(cloud.labels, Label::h), 100);
  EXPECT_GT(std::ranges::count(cloud.labels, Label::v), 100);
}

}  // namespace
}  // namespace planescope::lab
