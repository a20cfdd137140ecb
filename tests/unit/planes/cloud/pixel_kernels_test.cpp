// Tests of the vectorized pixel kernels against scalar code.

#include "core/planes/simd/pixel_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "core/planes/cloud/camera.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::planes {
namespace {

std::vector<Simd> simds_here() {
  std::vector<Simd> all;
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512})
    if (simd <= best_simd()) all.push_back(simd);
  return all;
}

/// All kinds of counts: holes, the far outlier, limits of the range.
std::uint16_t random_counts(std::mt19937& random) {
  switch (random() % 8) {
    case 0:
      return 0;
    case 1:
      return 65535;
    case 2:
      return static_cast<std::uint16_t>(1499 + random() % 3);
    default:
      return static_cast<std::uint16_t>(300 + random() % 2000);
  }
}

Frame random_frame(int width, int height, Distortion distortion, unsigned seed) {
  std::mt19937 random(seed);
  Frame frame;
  frame.name = "random";
  frame.depth = Image16(width, height);
  // Also single rows of points, like those of cameras.
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      frame.depth.at(u, v) =
          v % 3 == 0 ? static_cast<std::uint16_t>(700 + 3 * v + u) : random_counts(random);
  frame.depth_unit_m = 0.001;
  frame.intrinsics = {width,       height,       0.4 * width, 0.4 * width,
                      0.5 * width, 0.5 * height, distortion,  {}};
  // Folds back near the corners, where pixels have no ray.
  if (distortion != Distortion::none) frame.intrinsics.coefficients = {-0.3, 0.02, 0.01, 0, 0};
  return frame;
}

void expect_plain_cloud(const Frame& frame, const Cloud& cloud, double max_range_m) {
  const Mat3d turn = cloud.T_world_sensor.linear();
  CloudCounts counts;
  std::size_t i = 0;
  for (std::size_t pixel = 0; pixel < frame.depth.pixels(); ++pixel) {
    const auto u = static_cast<double>(pixel % frame.depth.width);
    const auto v = static_cast<double>(pixel / frame.depth.width);
    const std::uint16_t depth = frame.depth.data[pixel];
    const Vec2d ray = pixel_to_ray(frame.intrinsics, u, v);
    ++counts.pixels;
    if (depth == 0) {
      ++counts.no_measurement;
      continue;
    }
    if (depth == 65535 || std::isnan(ray.x())) {
      ++counts.invalid;
      continue;
    }
    ASSERT_LT(i, cloud.points.size());
    EXPECT_EQ(cloud.source[i], pixel);
    const double z = depth * frame.depth_unit_m;
    const Vec3d point = turn * Vec3d(ray.x() * z, ray.y() * z, z);
    EXPECT_LT((cloud.points[i].cast<double>() - point).norm(), 1e-6 * std::max(1.0, point.norm()));
    const Vec3d offset = cloud.points[i].cast<double>() - cloud.cube.min_corner;
    const bool inside = offset.minCoeff() >= 0 && offset.maxCoeff() < cloud.cube.edge_m;
    EXPECT_EQ(cloud.kept[i], z <= max_range_m && inside ? 1 : 0) << depth;
    ++(z > max_range_m ? counts.beyond_range : inside ? counts.kept : counts.outside_cube);
    ++i;
  }
  EXPECT_EQ(i, cloud.points.size());
  EXPECT_EQ(cloud.counts.pixels, counts.pixels);
  EXPECT_EQ(cloud.counts.no_measurement, counts.no_measurement);
  EXPECT_EQ(cloud.counts.invalid, counts.invalid);
  EXPECT_EQ(cloud.counts.beyond_range, counts.beyond_range);
  EXPECT_EQ(cloud.counts.outside_cube, counts.outside_cube);
  EXPECT_EQ(cloud.counts.kept, counts.kept);
}

TEST(PixelKernels, MakeTheSameCloudAsScalarCode) {
  Gravity gravity;
  gravity.direction = Vec3d(0.1, 0.8, 0.5).normalized();
  for (const Distortion distortion :
       {Distortion::none, Distortion::brown_conrady, Distortion::inverse_brown_conrady})
    for (const int width : {1, 7, 64, 131})
      for (const double range_m : {0.7995, 1.5, 40.0}) {
        const Frame frame = random_frame(width, 40, distortion, static_cast<unsigned>(width));
        CloudOptions options;
        options.max_range_m = range_m;
        expect_plain_cloud(frame, make_cloud(frame, gravity, options), range_m);
      }
}

TEST(PixelKernels, AreTheSameForEveryInstructionSet) {
  constexpr std::size_t kCount = 131;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<std::uint16_t> depth(kCount);
  std::vector<double> ray_x(kCount), ray_y(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    depth[i] = random_counts(random);
    ray_x[i] = ray_y[i] = std::numeric_limits<double>::quiet_NaN();
    if (i % 9 != 0) ray_x[i] = normal(random), ray_y[i] = normal(random);
  }
  struct Projected {
    std::vector<float> x = std::vector<float>(kCount), y = x, z = x;
    std::vector<std::uint8_t> fate = std::vector<std::uint8_t>(kCount);
    std::uint64_t fates[5] = {};
  };
  const auto project = [&](Simd simd) {
    Projected p;
    ProjectArgs args{.count = kCount,
                     .depth = depth.data(),
                     .ray_x = ray_x.data(),
                     .ray_y = ray_y.data(),
                     .unit_m = 0.001,
                     .turn = {{0.6, -0.64, 0.48}, {0.8, 0.48, -0.36}, {0, 0.6, 0.8}},
                     .most_counts = 1500,
                     .from = {-1, -1, -1},
                     .to = {1, 1, 1},
                     .x = p.x.data(),
                     .y = p.y.data(),
                     .z = p.z.data(),
                     .fate = p.fate.data(),
                     .pixels_of_fate = p.fates};
    pixel_kernels(simd).project(args);
    return p;
  };
  const auto bits = [](const std::vector<float>& values) {
    std::vector<std::uint32_t> result;
    for (const float value : values)
      result.push_back(std::isnan(value) ? 0 : std::bit_cast<std::uint32_t>(value));
    return result;
  };
  const Projected plain = project(Simd::plain);
  for (const Simd simd : simds_here()) {
    const Projected other = project(simd);
    EXPECT_EQ(bits(other.x), bits(plain.x)) << to_string(simd);
    EXPECT_EQ(bits(other.y), bits(plain.y)) << to_string(simd);
    EXPECT_EQ(bits(other.z), bits(plain.z)) << to_string(simd);
    EXPECT_EQ(other.fate, plain.fate) << to_string(simd);
    EXPECT_TRUE(std::ranges::equal(other.fates, plain.fates)) << to_string(simd);
  }
  for (int fate = 0; fate < 5; ++fate)
    EXPECT_EQ(plain.fates[fate], std::ranges::count(plain.fate, fate)) << fate;
}

TEST(PixelKernels, SumAPatchLikeScalarCode) {
  constexpr std::size_t kPatches = 16, kPixels = 5;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::vector<std::uint16_t> depth(kPatches * kPixels);
  std::vector<double> ray_x(depth.size()), ray_y(depth.size());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = random_counts(random);
    ray_x[i] = normal(random), ray_y[i] = normal(random);
  }
  std::vector<double> expected(kInverseSums * kPatches);
  for (std::size_t p = 0; p < kPatches; ++p)
    for (std::size_t i = 0; i < kPixels; ++i) {
      const std::size_t at = i * kPatches + p;
      const double z = depth[at] * 0.001, x = ray_x[at], y = ray_y[at], w = 1 / z;
      if (z <= 0 || z > 10) continue;
      const double products[kInverseSums] = {x * x, x * y, x, y * y, y, 1, x * w, y * w, w, w * w};
      for (std::size_t s = 0; s < kInverseSums; ++s) expected[s * kPatches + p] += products[s];
    }
  for (const Simd simd : simds_here()) {
    std::vector<double> sums(expected.size());
    pixel_kernels(simd).add_to_patches({.patches = kPatches,
                                        .pixels = kPixels,
                                        .depth = depth.data(),
                                        .ray_x = ray_x.data(),
                                        .ray_y = ray_y.data(),
                                        .unit_m = 0.001,
                                        .max_depth_m = 10,
                                        .sums = sums.data()});
    EXPECT_EQ(sums, expected) << to_string(simd);
  }
}

TEST(PixelKernels, FindThePatchesOnAPlane) {
  constexpr std::size_t kCount = 64;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(-0.5, 0.5);
  std::vector<double> ray[3], normal[3], w(kCount), most(kCount, 0.1);
  for (int axis = 0; axis < 3; ++axis) ray[axis].resize(kCount), normal[axis].resize(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    for (int axis = 0; axis < 3; ++axis) ray[axis][i] = axis == 2 ? 1 : at(random);
    for (int axis = 0; axis < 3; ++axis) normal[axis][i] = at(random);
    w[i] = 1 + 0.4 * at(random);
  }
  const Vec3d plane(0.1, -0.2, 1), facing(0, 0.6, -0.8);
  for (const Simd simd : simds_here()) {
    std::vector<std::uint8_t> on(kCount);
    OnPlaneArgs args{
        .count = kCount, .w = w.data(), .most = most.data(), .least_cosine = 0.1, .on = on.data()};
    for (int axis = 0; axis < 3; ++axis) {
      args.ray[axis] = ray[axis].data(), args.normal[axis] = normal[axis].data();
      args.w_of_ray[axis] = plane[axis], args.plane_normal[axis] = facing[axis];
    }
    pixel_kernels(simd).find_on_plane(args);
    int found = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vec3d r(ray[0][i], ray[1][i], ray[2][i]), n(normal[0][i], normal[1][i], normal[2][i]);
      EXPECT_EQ(on[i], std::abs(plane.dot(r) - w[i]) <= most[i] && n.dot(facing) >= 0.1 ? 1 : 0);
      found += on[i];
    }
    EXPECT_GT(found, 3) << to_string(simd);
  }
}

}  // namespace
}  // namespace planescope::planes
