// Planes in depth images, found by minimizing one objective.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/model/random.hpp"
#include "core/planes/depth/regions.hpp"
#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

using test::depth_frame;
using test::plane_at;

FrameResult planes_of(const Frame& frame,
                      const std::function<void(PipelineOptions&)>& change = {},
                      Trace* trace = nullptr) {
  PipelineOptions options = test::wall_options();
  if (change) change(options);
  return run_frame(frame, options, nullptr, nullptr, trace);
}

/// Smallest IoU between a plane of `a` and the best-matching plane of `b`.
double least_iou(const FrameResult& a, const FrameResult& b) {
  std::map<std::pair<int, int>, double> both;
  std::map<int, double> in_a, in_b;
  for (std::size_t i = 0; i < a.plane_of.size(); ++i) {
    const int p = a.plane_of[i], q = b.plane_of[i];
    ++both[{p, q}], ++in_a[p], ++in_b[q];
  }
  std::map<int, double> best;
  for (const auto& [pair, n] : both)
    if (pair.first > 0 && pair.second > 0)
      best[pair.first] = std::max(best[pair.first], n / (in_a[pair.first] + in_b[pair.second] - n));
  double least = 1;
  for (const auto& [plane, n] : in_a)
    if (plane > 0) least = std::min(least, best[plane]);
  return least;
}

/// A wall at 2 m, a floor, and a box on it, of which the front and the top are visible.
double room(double x, double y) {
  const double wall = 2, floor = y > 0 ? 0.6 / y : 10;
  const double front = 1.1, top = y > 0 ? 0.35 / y : 10;
  double depth = std::min(wall, floor);
  if (std::abs(x * front) < 0.25 && y * front > 0.35 && y * front < 0.6)
    depth = std::min(depth, front);
  if (std::abs(x * top) < 0.25 && top > front && top < 1.5) depth = std::min(depth, top);
  return depth;
}

TEST(InverseDepth, PlanesAreAffineInPixels) {
  PixelMoments moments;
  for (int v = -20; v < 20; ++v)
    for (int u = -30; u < 30; ++u) moments.add(u, v, 0.5 + 0.002 * u - 0.001 * v);
  const InversePlane plane = moments.fit();
  EXPECT_NEAR(plane.a, 0.002, 1e-12);
  EXPECT_NEAR(plane.b, -0.001, 1e-12);
  EXPECT_NEAR(plane.c, 0.5, 1e-12);
  EXPECT_NEAR(plane.sse, 0, 1e-12);
}

TEST(InverseDepth, MomentsOfAUnionAreTheSum) {
  Random random(3);
  PixelMoments all, left, right;
  for (int k = 0; k < 500; ++k) {
    const double u = random.normal() * 50, v = random.normal() * 50,
                 rho = 1 + 0.01 * random.normal();
    all.add(u, v, rho);
    (k % 3 ? left : right).add(u, v, rho);
  }
  left += right;
  EXPECT_NEAR(left.fit().a, all.fit().a, 1e-12);
  EXPECT_NEAR(left.fit().sse, all.fit().sse, 1e-9);
  left -= right;
  for (int k = 0; k < 3; ++k) left.add(k, k, 1), left.remove(k, k, 1);
  EXPECT_NEAR(left.n + right.n, 500, 1e-9);
}

DepthImage image_of(int width, int height, const std::function<double(int, int)>& rho) {
  DepthImage image{width, height, 0, {}};
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) image.rho.push_back(static_cast<float>(rho(u, v)));
  return image;
}

TEST(DepthCells, ContainEachMeasuredPixelOnce) {
  Random random(5);
  const DepthImage image = image_of(101, 67, [&](int u, int v) {
    return (u * 7 + v) % 5 == 0 ? 0.0
                                : 0.3 + 0.01 * u + 0.5 * ((u / 20) % 2) + 0.001 * random.normal();
  });
  const DepthCells cells = make_depth_cells(image);
  std::vector<std::uint32_t> pixels = cells.pixels;
  std::ranges::sort(pixels);
  std::vector<std::uint32_t> measured;
  for (std::uint32_t i = 0; i < image.pixels(); ++i)
    if (image.rho[i] > 0) measured.push_back(i);
  EXPECT_EQ(pixels, measured);
  PixelMoments all;
  for (const std::uint32_t i : measured)
    all.add(image.u(static_cast<int>(i) % 101), image.v(static_cast<int>(i) / 101), image.rho[i]);
  ASSERT_EQ(cells.levels.back().size(), 1u);
  const PixelMoments& root = cells.levels.back()[0].moments;
  EXPECT_EQ(root.n, all.n);
  EXPECT_NEAR(root.uv, all.uv, 1e-6 * std::abs(all.uv) + 1e-6);
  EXPECT_NEAR(root.vr, all.vr, 1e-6 * std::abs(all.vr) + 1e-6);
  EXPECT_NEAR(root.rr, all.rr, 1e-9 * all.rr);
}

TEST(DepthCells, SeparateDistantSurfaces) {
  const DepthImage image = image_of(64, 64, [](int u, int v) { return (u + v) % 2 ? 1.0 : 0.5; });
  const DepthCells cells = make_depth_cells(image);
  EXPECT_EQ(cells.levels[0].size(), 2u * 16 * 16);
  for (const DepthCell& leaf : cells.levels[0]) EXPECT_LT(leaf.moments.fit().sse, 1e-9);
}

TEST(DepthNoise, IsMeasuredInTheImage) {
  Random random(7);
  const DepthImage white =
      image_of(640, 480, [&](int u, int) { return 0.5 + 1e-4 * u + 0.002 * random.normal(); });
  const auto measured = [](const DepthImage& image) {
    const DepthCells cells = make_depth_cells(image);
    return measure_depth_noise(cells.blocks, cells.block_columns, image.width, 0, {});
  };
  EXPECT_NEAR(measured(white).white, 0.002, 2e-4);
  EXPECT_LT(measured(white).bow, 0.0025);  // at least 2.5 times a fifth of the white noise
  const DepthImage bowed = image_of(640, 480, [&](int u, int v) {
    return 0.5 + 0.006 * std::sin(u * std::numbers::pi / 30) * std::cos(v * std::numbers::pi / 30) +
           0.002 * random.normal();
  });
  EXPECT_NEAR(measured(bowed).white, 0.002, 4e-4);
  EXPECT_GT(measured(bowed).bow, 0.004);
  EXPECT_EQ(measured(image_of(64, 48, [](int, int) { return 0; })).white, 0);
}

TEST(DepthPlanes, AreFoundInARoom) {
  const FrameResult result = planes_of(depth_frame(room));
  const int wall = plane_at(result, 320, 100), floor = plane_at(result, 100, 450);
  const int front = plane_at(result, 320, 410);
  const int top = plane_at(result, 320, 345);
  for (const int plane : {wall, floor, front, top}) EXPECT_GT(plane, 0);
  EXPECT_EQ((std::set<int>{wall, floor, front, top}).size(), 4u);
  EXPECT_EQ(result.segmentation.planes.size(), 4u);
  EXPECT_EQ(plane_at(result, 560, 450), floor);
  const PlaneRegion& ground = result.segmentation.planes[static_cast<std::size_t>(floor) - 1];
  EXPECT_EQ(ground.label, Label::h);
  EXPECT_GT(ground.fit.normal.z(), std::cos(0.5 * std::numbers::pi / 180));
  EXPECT_NEAR(ground.fit.offset_m(), -0.6, 0.005);
  EXPECT_EQ(result.segmentation.planes[static_cast<std::size_t>(wall) - 1].label, Label::v);
}

TEST(DepthPlanes, DependNeitherOnGravityNorOnTheFocalLength) {
  Frame frame = depth_frame(room);
  const FrameResult upright = planes_of(frame);
  frame.gravity->direction = Vec3d(0.3, 0.9, 0.2).normalized();
  EXPECT_EQ(planes_of(frame).plane_of, upright.plane_of);
  frame.gravity->source = GravitySource::none;
  EXPECT_EQ(planes_of(frame).plane_of, upright.plane_of);
  frame.intrinsics.fx *= 1.01;
  EXPECT_EQ(planes_of(frame).plane_of, upright.plane_of);
}

TEST(DepthPlanes, DoNotChangeWhenSomePixelsMoveByOneCount) {
  Frame frame = depth_frame(room);
  frame.depth_unit_m = 0.0002;
  const FrameResult before = planes_of(frame);
  Random random(11);
  for (std::uint16_t& counts : frame.depth.data)
    if (counts > 1 && random.uniform() < 0.05)
      counts = static_cast<std::uint16_t>(counts + (random.uniform() < 0.5 ? 1 : -1));
  const FrameResult after = planes_of(frame);
  EXPECT_EQ(after.segmentation.planes.size(), before.segmentation.planes.size());
  EXPECT_GE(least_iou(before, after), 0.98);
}

TEST(DepthPlanes, AreTheSameWithoutATrace) {
  const Frame frame = depth_frame(room);
  Trace trace;
  const FrameResult traced = planes_of(frame, {}, &trace), plain = planes_of(frame);
  EXPECT_EQ(traced.plane_of, plain.plane_of);
  EXPECT_EQ(traced.segmentation.counts.nodes_visited, plain.segmentation.counts.nodes_visited);
  EXPECT_EQ(traced.segmentation.octree.nodes.size(), plain.segmentation.octree.nodes.size());
  EXPECT_EQ(trace.visited_at.size(), traced.segmentation.octree.nodes.size());
  EXPECT_EQ(trace.decided_at.size(), trace.visited_at.size());
  EXPECT_EQ(traced.segmentation.octree.points.size(), traced.plane_of.size());
}

TEST(DepthPlanes, KeepATreadOfTwoCentimeters) {
  // The floor rises by 2 cm along a line 1.2 m ahead.
  const auto stepped = [](double, double y) {
    if (y <= 0.2) return 0.0;
    const double low = 0.6 / y, high = 0.58 / y;
    return high >= 1.2 ? high : std::min(low, 1.2);
  };
  const FrameResult result = planes_of(depth_frame(stepped, 0.001));
  const int low = plane_at(result, 320, 465), high = plane_at(result, 320, 400);
  EXPECT_GT(low, 0);
  EXPECT_GT(high, 0);
  EXPECT_NE(low, high);
  EXPECT_EQ(high, plane_at(result, 320, 340));
}

/// One wall behind a post, or two walls with a gap between them.
double parted(double x, bool post) { return std::abs(x) < 0.06 ? (post ? 0.8 : 3.0) : 1.5; }

TEST(DepthPlanes, JoinBehindOccluders) {
  const FrameResult post = planes_of(depth_frame([](double x, double) { return parted(x, true); }));
  EXPECT_GT(plane_at(post, 100, 240), 0);
  EXPECT_EQ(plane_at(post, 100, 240), plane_at(post, 540, 240));
  const FrameResult gap = planes_of(depth_frame([](double x, double) { return parted(x, false); }));
  EXPECT_GT(plane_at(gap, 100, 240), 0);
  EXPECT_NE(plane_at(gap, 100, 240), plane_at(gap, 540, 240));
}

TEST(DepthPlanes, AreUndecidedIfASmallChangeWouldLoseThem) {
  const FrameResult result = planes_of(depth_frame(room));
  for (const PlaneRegion& plane : result.segmentation.planes) {
    EXPECT_FALSE(plane.undecided) << plane.id << ": " << plane.margin;
    EXPECT_TRUE(std::isfinite(plane.margin));
  }
  // Barely listed.
  const PlaneRegion& least =
      *std::ranges::min_element(result.segmentation.planes, {}, &PlaneRegion::margin);
  const FrameResult near = planes_of(depth_frame(room), [&](PipelineOptions& options) {
    options.segment.objective.undecided = least.margin * 1.01 + 1e-6;
  });
  EXPECT_TRUE(std::ranges::any_of(near.segmentation.planes, &PlaneRegion::undecided));
}

TEST(DepthPlanes, AreNotFoundInAnImageWithoutDepth) {
  const FrameResult none = planes_of(depth_frame([](double, double) { return 0.0; }));
  EXPECT_TRUE(none.segmentation.planes.empty());
  EXPECT_TRUE(none.plane_of.empty());
  const FrameResult far = planes_of(depth_frame([](double, double) { return 8.0; }));
  EXPECT_TRUE(far.segmentation.planes.empty());
}

}  // namespace
}  // namespace planescope::planes
