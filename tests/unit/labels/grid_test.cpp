// Tests of the label grid: points, normals, noise, fitted planes and fragments.

#include "core/labels/model/grid.hpp"

#include <gtest/gtest.h>

#include "core/labels/model/pixel_sets.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "small_frames.hpp"
#include "support/refusal.hpp"
#include "support/render_depth.hpp"

namespace planescope::labels {
namespace {

TEST(LabelGrid, HasTheMeasurementsOfTheFramesCloud) {
  Frame frame = test::frame_of(24, 18, [](int u, int v) { return 0.5 + 0.02 * u + 0.01 * v; });
  frame.depth.at(3, 4) = 0;
  frame.depth.at(5, 6) = 65535;
  frame.intrinsics.distortion = Distortion::brown_conrady;
  frame.intrinsics.coefficients = {-0.9, 0.3, 0, 0, 0};  // folds back in the corners
  const LabelGrid grid = make_label_grid(frame, Gravity{});
  PixelSet measured;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (grid.measured[i]) measured.push_back(static_cast<std::uint32_t>(i));
  EXPECT_EQ(measured, planes::measured_sources(frame));
  EXPECT_EQ(grid.measured_count, measured.size());
  EXPECT_TRUE(grid.points[4 * 24 + 3].hasNaN());
  EXPECT_TRUE(grid.normals[4 * 24 + 3].isZero(0));
}

TEST(LabelGrid, RejectsAnEmptyCloudAndIntrinsicsOfAnotherSize) {
  Frame cloud;
  cloud.name = "none";
  cloud.cloud = PointSet{};
  expect_refused([&] { make_label_grid(cloud, Gravity{}); }, "has no points");
  Frame frame = test::frame_of(8, 6, [](int, int) { return 1.0; });
  frame.intrinsics.width = 9;
  EXPECT_THROW(make_label_grid(frame, Gravity{}), Error);
}

TEST(LabelGrid, OnlyAlignedColorIsUsed) {
  Frame frame = test::frame_of(8, 6, [](int, int) { return 1.0; });
  frame.color = Image8(8, 6, 3, 50);
  EXPECT_TRUE(make_label_grid(frame, Gravity{}).color.empty());
  frame.color_aligned = true;
  EXPECT_EQ(make_label_grid(frame, Gravity{}).color.data, frame.color.data);
}

TEST(LabelGrid, NormalsPointFromTheSurfaceToTheSensor) {
  const LabelGrid grid = test::wall_grid();
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    EXPECT_LT((grid.normals[i] - Vec3f(0, 0, -1)).norm(), 1e-3) << i;
}

TEST(LabelGrid, NormalsBesideADepthEdgeAreThoseOfTheirOwnSide) {
  // A wall at 1 m, with a slanted board in front of its middle.
  const auto board = [](int u) { return u >= 20 && u < 40; };
  const LabelGrid grid = make_label_grid(
      test::frame_of(60, 40, [&](int u, int) { return board(u) ? 0.5 + 0.004 * (u - 20) : 1.0; }),
      Gravity{});
  for (int u = 0; u < 60; ++u) {
    const Vec3f& normal = grid.normals[test::pixel_at(grid, u, 20)];
    const bool faces_along = normal.z() < -0.99f;
    EXPECT_EQ(faces_along, !board(u)) << u << ": " << normal.transpose();
  }
}

TEST(LabelGrid, NoiseIsMeasuredAndGrowsWithTheSquareOfDepth) {
  test::Camera camera;
  const std::vector<test::Parallelogram> scene{
      {Vec3d(-5, -5, 0), Vec3d(20, 0, 0), Vec3d(0, 10, 0)}};
  camera.pitch_deg = 40;
  camera.noise_px = 0.1;
  const Frame frame = test::render_depth(scene, camera);
  const LabelGrid grid = make_label_grid(frame, Gravity{});
  for (const int v : {80, 240, 400}) {
    const std::size_t i = static_cast<std::size_t>(v) * 640 + 320;
    const double z = grid.points[i].z();
    const double expected = 0.7 * camera.noise_px * z * z / (385 * 0.05);  // interpolated noise
    EXPECT_GT(grid.sigma_m[i], 0.6 * expected) << v;
    EXPECT_LT(grid.sigma_m[i], 2.0 * expected) << v;
  }
}

TEST(LabelGrid, PixelsAddUpToTheAreaOfAWallAndCoverMoreOfASlantedOne) {
  const LabelGrid grid = test::wall_grid();
  EXPECT_NEAR(grid.area_m2(test::rectangle(grid, 0, 0, 40, 30)), 0.4 * 0.3, 1e-4);
  const std::uint32_t middle = test::pixel_at(grid, 20, 15);
  const Vec3d slanted = Vec3d(0, -1, -1).normalized();
  EXPECT_NEAR(grid.pixel_area_m2(middle, &slanted), std::sqrt(2) * grid.pixel_area_m2(middle),
              1e-6);
}

TEST(FittedPlane, FitsThePointsAndFacesTheSensor) {
  const LabelGrid grid = test::wall_grid();
  const FittedPlane plane = fit_plane(grid, test::rectangle(grid, 5, 5, 20, 20));
  EXPECT_LT((plane.normal - Vec3d(0, 0, -1)).norm(), 1e-6);
  EXPECT_NEAR(plane.offset_m, -1, 1e-6);
  EXPECT_NEAR(plane.tilt_deg, 90, 1e-3);
  EXPECT_NEAR(plane.area_m2, 0.15 * 0.15, 1e-6);
  EXPECT_EQ(plane.points, 225u);
  EXPECT_NEAR(plane.rms_m, 0, 1e-6);
  EXPECT_NEAR(plane.distance_m(Vec3f(0, 0, 0.9f)), 0.1, 1e-6);
}

TEST(FittedPlane, CollinearPointsAreNotAPlane) {
  const LabelGrid grid = test::wall_grid();
  EXPECT_LT(fit_plane(grid, test::rectangle(grid, 5, 5, 20, 6)).points, 3u);
  EXPECT_EQ(fit_plane(grid, test::rectangle(grid, 5, 5, 7, 6)).points, 2u);
  EXPECT_EQ(fit_plane(grid, {}).points, 0u);
}

TEST(FittedPlane, FloorsAndCeilingsAreHorizontal) {
  EXPECT_EQ(class_of_tilt(0), Label::h);
  EXPECT_EQ(class_of_tilt(44), Label::h);
  EXPECT_EQ(class_of_tilt(46), Label::v);
  EXPECT_EQ(class_of_tilt(90), Label::v);
  EXPECT_EQ(class_of_tilt(180), Label::h);
}

TEST(Fragments, PartsThatTouchOnlyAtACornerAreTwo) {
  Image16 image(4, 3);
  image.data = {5, 5, 0, 2,  //
                0, 5, 0, 2,  //
                5, 0, 2, 0};
  const auto counts = count_fragments(image);
  ASSERT_EQ(counts.size(), 6u);
  EXPECT_EQ(counts[5], 2);
  EXPECT_EQ(counts[2], 2);
  EXPECT_EQ(counts[1], 0);
}

TEST(Fragments, ASpiralIsOnePart) {
  Image16 image(5, 5);
  image.data = {1, 1, 1, 1, 1,  //
                0, 0, 0, 0, 1,  //
                1, 1, 1, 0, 1,  //
                1, 0, 0, 0, 1,  //
                1, 1, 1, 1, 1};
  EXPECT_EQ(count_fragments(image)[1], 1);
}

}  // namespace
}  // namespace planescope::labels
