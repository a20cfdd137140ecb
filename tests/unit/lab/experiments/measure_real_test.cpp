// Tests of repeatability between neighboring frames, and of floor pieces.

#include "core/lab/experiments/measure_real.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace planescope::lab {
namespace {

constexpr int kSide = 100;  // width and height of the image [px]

/// A plane on the left half of the image, and another on the right.
PixelPlanes halves(double offset_m = 1, double tilt_rad = 0) {
  PixelPlanes planes;
  for (int i = 0; i < kSide * kSide; ++i) planes.plane_of.push_back(i % kSide < kSide / 2 ? 1 : 2);
  planes.fits.resize(2);
  planes.certainties.resize(2);
  planes.certainties[1].axes[1] = Vec3d::UnitZ();
  for (planes::Certainty& certainty : planes.certainties)
    for (double& sigma : certainty.sigma_tilt_rad) sigma = 0.004;
  planes.fits[0].centroid = Vec3d(0, 0, offset_m);
  planes.fits[1].normal = Vec3d(std::sin(tilt_rad), std::cos(tilt_rad), 0);
  return planes;
}

TEST(Repeatability, PlanesAreMatchedByPixelsForAnyNumbering) {
  const PixelPlanes first = halves();
  PixelPlanes next = halves(1.02, 0.01);
  for (auto& plane : next.plane_of) plane = 3 - plane;
  std::swap(next.fits[0], next.fits[1]);
  next.fits[1].normal *= -1;  // the same plane
  const Neighbors n = compare_neighbors(first, next);
  EXPECT_EQ(n.planes, 2);
  EXPECT_EQ(n.partners, 2);
  EXPECT_NEAR(n.offset_jumps_m[0], 0.02, 1e-9);
  EXPECT_NEAR(n.offset_jumps_m[1], 0, 1e-9);
  EXPECT_NEAR(n.normal_jumps_deg[0], 0, 1e-6);
  EXPECT_NEAR(n.normal_jumps_deg[1], 0.01 * 180 / M_PI, 1e-6);
}

TEST(Repeatability, ChangesOfAnAngleAreMeasuredInSigmasOfFourPlanes) {
  const PixelPlanes first = halves();
  PixelPlanes next = halves();
  next.fits[1].normal = Vec3d(0, std::cos(0.01), std::sin(0.01));
  const Neighbors n = compare_neighbors(first, next);
  ASSERT_EQ(n.angle_jumps_sigmas.size(), 1u);
  EXPECT_NEAR(std::abs(n.angle_jumps_sigmas[0]), 0.01 / (2 * 0.004), 1e-3);
  const double turn = 0.3;  // of the camera
  next = halves();
  for (std::size_t p = 0; p < 2; ++p) {
    const Eigen::AngleAxisd turned(turn, Vec3d::UnitX());
    next.fits[p].normal = turned * next.fits[p].normal;
    for (Vec3d& axis : next.certainties[p].axes) axis = turned * axis;
  }
  EXPECT_NEAR(compare_neighbors(first, next).angle_jumps_sigmas.at(0), 0, 1e-9);
  for (PlaneFit& fit : next.fits) fit.normal = Vec3d::UnitZ();
  EXPECT_TRUE(compare_neighbors(next, next).angle_jumps_sigmas.empty()) << "parallel ones";
}

TEST(Repeatability, ASplitOrSmallPlaneHasNoPartner) {
  PixelPlanes first = halves(), next = halves();
  next.fits.resize(4);
  next.certainties.resize(4);
  for (int i = 0; i < kSide * kSide; ++i)  // thirds of the left plane
    if (next.plane_of[i] == 1 && i >= kSide * kSide / 3)
      next.plane_of[i] = i < kSide * kSide * 2 / 3 ? 3 : 4;
  EXPECT_EQ(compare_neighbors(first, next).planes, 2);
  EXPECT_EQ(compare_neighbors(first, next).partners, 1);
  first.fits.resize(3);
  first.certainties.resize(3);
  std::fill(first.plane_of.begin(), first.plane_of.begin() + 499, 3);
  EXPECT_EQ(compare_neighbors(first, next).planes, 2) << "499 pixels do not count";
}

/// A level floor 0.6 m below a camera that looks down by 30 degrees, and a wall 2.5 m ahead.
planes::PreparedFrame floor_and_wall(double rise) {
  planes::PreparedFrame frame;
  const double down = 30 * M_PI / 180;
  frame.cloud = {};
  frame.cloud.T_world_sensor.linear().col(0) = -Vec3d::UnitY();
  frame.cloud.T_world_sensor.linear().col(1) = Vec3d(-std::sin(down), 0, -std::cos(down));
  frame.cloud.T_world_sensor.linear().col(2) = Vec3d(std::cos(down), 0, -std::sin(down));
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u) {
      const Vec3d ray = frame.cloud.T_world_sensor.linear() *
                        Vec3d((u - kSide / 2) / 100.0, (v - kSide / 2) / 100.0, 1);
      const double to_wall = 2.5 / ray.x(), to_floor = -0.6 / (ray.z() - rise * ray.x());
      const bool is_floor = to_floor > 0 && to_floor < to_wall;
      frame.cloud.points.push_back(((is_floor ? to_floor : to_wall) * ray).cast<float>());
      frame.cloud.source.push_back(static_cast<std::uint32_t>(v * kSide + u));
      frame.cloud.kept.push_back(1);
    }
  frame.cloud.counts.pixels = kSide * kSide;
  return frame;
}

TEST(Repeatability, TheFloorIsFoundByPixelsEvenIfGravityIsSlightlyOff) {
  for (const double rise : {0.0, 0.02}) {
    const planes::PreparedFrame frame = floor_and_wall(rise);
    const std::vector<std::uint8_t> floor = floor_pixels(frame);
    int right = 0;
    for (std::size_t i = 0; i < floor.size(); ++i) {
      const Vec3f& p = frame.cloud.points[i];
      right += floor[i] == (std::abs(p.z() - (-0.6 + rise * p.x())) < 1e-4);
    }
    EXPECT_GT(right, 0.96 * kSide * kSide) << rise;  // except for the foot of the wall
  }
}

TEST(Repeatability, AFrameWithNothingBelowTheCameraHasNoFloor) {
  planes::PreparedFrame frame = floor_and_wall(0);
  std::fill(frame.cloud.kept.begin(), frame.cloud.kept.end(), std::uint8_t{0});
  const std::vector<std::uint8_t> floor = floor_pixels(frame);
  EXPECT_EQ(std::count(floor.begin(), floor.end(), 1), 0);
  EXPECT_EQ(floor_pieces(floor, halves()).largest, 0);
}

TEST(Repeatability, ThePiecesOfTheFloorArePlanesMostlyOnIt) {
  std::vector<std::uint8_t> floor(kSide * kSide, 0);
  PixelPlanes found = halves();
  std::fill(floor.begin() + kSide * kSide / 2, floor.end(), std::uint8_t{1});
  FloorPieces pieces = floor_pieces(floor, found);  // half of either plane
  EXPECT_EQ(pieces.pixels, static_cast<std::uint64_t>(kSide * kSide / 2));
  EXPECT_EQ(pieces.pieces, 2);
  EXPECT_EQ(pieces.largest, 50);
  EXPECT_EQ(pieces.missing, 0);
  floor[kSide * kSide - 1] = 0;  // less than half of the right one
  EXPECT_EQ(floor_pieces(floor, found).pieces, 1);
  for (int i = 0; i < kSide * kSide; ++i)
    if (found.plane_of[i] == 2) found.plane_of[i] = 0;
  pieces = floor_pieces(floor, found);
  EXPECT_EQ(pieces.largest, 100);
  EXPECT_NEAR(pieces.missing, 50, 0.1);
}

}  // namespace
}  // namespace planescope::lab
