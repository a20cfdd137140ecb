#include <gtest/gtest.h>

#include <cmath>

#include "core/model/random.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {
namespace {

std::vector<Vec3f> points_in_box(const Vec3f& min, const Vec3f& max, int count) {
  Random random(7);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    Vec3f at;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = min[axis] + static_cast<float>(random.uniform()) * (max[axis] - min[axis]);
    points.push_back(at);
  }
  return points;
}

/// How far the points reach from the middle of the view towards its borders, 1: up to them.
Vec2d reach_in_view(const std::vector<Vec3f>& points, const Camera& camera, double aspect) {
  const int height = 1000, width = static_cast<int>(1000 * aspect);
  const View view = make_view(camera, width, height);
  Vec2d most = Vec2d::Zero();
  for (const Vec3f& point : points) {
    const auto seen = project(view, point);
    if (!seen) return Vec2d::Constant(1e9);
    most.x() = std::max(most.x(), std::abs(seen->px.x() / width - 0.5) * 2);
    most.y() = std::max(most.y(), std::abs(seen->px.y() / height - 0.5) * 2);
  }
  return most;
}

TEST(Framing, FillsViewsOfEveryShapeAndCutsNothingOff) {
  const std::vector<Vec3f> points = points_in_box({1, -2, 0}, {4, 2, 1.5}, 5000);
  const std::vector<Vec3f> reach = reach_of(points, 0);
  for (const double aspect : {0.4, 1.0, 4.0 / 3, 2.6})
    for (const Vec3d& forward : {Vec3d(1, 0, 0), Vec3d(0.8, 0.2, -0.5), Vec3d(0, 0, -1)}) {
      Lens lens{.forward = forward.normalized(), .aspect = aspect};
      if (forward.x() == 0) lens.up = Vec3d::UnitX();
      const Vec2d most = reach_in_view(points, camera_holding(reach, lens), aspect);
      EXPECT_LT(most.maxCoeff(), 1) << aspect << " " << forward.transpose();
      EXPECT_GT(most.maxCoeff(), 0.85) << aspect << " " << forward.transpose();
    }
}

TEST(Framing, AnOrthographicViewIsFilledToo) {
  const std::vector<Vec3f> points = points_in_box({1, -2, 0}, {9, 2, 1.5}, 5000);
  for (const double aspect : {0.5, 2.0}) {
    Camera camera = camera_holding(reach_of(points, 0), {.aspect = aspect, .orthographic = true});
    camera.orthographic = true;
    camera.ortho_height_m =
        2 * (camera.eye - camera.target).norm() * std::tan(camera.fov_y_deg * M_PI / 360);
    camera.eye = camera.target - Vec3d(50, 0, 0);
    const Vec2d most = reach_in_view(points, camera, aspect);
    EXPECT_LT(most.maxCoeff(), 1);
    EXPECT_GT(most.maxCoeff(), 0.85);
  }
}

TEST(Framing, WhatIsFewAndFarApartIsAside) {
  std::vector<Vec3f> points = points_in_box({0, 0, 0}, {2, 2, 0.1F}, 5000);
  const std::vector<Vec3f> speck = points_in_box({9, 9, 3}, {9.3F, 9.3F, 3.1F}, 60);
  const std::vector<Vec3f> wall = points_in_box({5, 0, 0}, {5.1F, 2, 2}, 1000);
  points.insert(points.end(), speck.begin(), speck.end());
  points.insert(points.end(), wall.begin(), wall.end());
  const std::vector<Vec3f> bulk = bulk_of(points, 0.25);
  EXPECT_EQ(bulk.size(), points.size() - speck.size()) << "a wall apart from the floor stays";
  for (const Vec3f& point : bulk) EXPECT_LT(point.x(), 6);
}

TEST(Framing, OfNothingIsFinite) {
  EXPECT_TRUE(reach_of({}, 0.01).empty());
  EXPECT_TRUE(bulk_of({}, 0.1).empty());
  EXPECT_TRUE(camera_holding({}, {}).eye.allFinite());
  const std::vector<Vec3f> one = {Vec3f(1, 2, 3)};
  EXPECT_GT((camera_holding(one, {}).eye - camera_holding(one, {}).target).norm(), 0.01);
}

TEST(View, TargetIsInTheMiddleAndUpIsUp) {
  Camera camera;
  camera.eye = Vec3d(3, -2, 1);
  camera.target = Vec3d(0.5, 0.5, 0.2);
  const View view = make_view(camera, 640, 480);
  const auto middle = project(view, camera.target.cast<float>());
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->px.x(), 320, 1e-3);
  EXPECT_NEAR(middle->px.y(), 240, 1e-3);
  EXPECT_NEAR(middle->depth_m, (camera.eye - camera.target).norm(), 1e-5);
  const auto above = project(view, Vec3f(0.5f, 0.5f, 0.3f));
  ASSERT_TRUE(above);
  EXPECT_LT(above->px.y(), 239);
  EXPECT_NEAR(above->px.x(), 320, 1e-3);
}

TEST(View, PixelsPerMetreAtTheTargetAreTrue) {
  for (const bool orthographic : {false, true}) {
    Camera camera;
    camera.eye = Vec3d(-2, 0, 0);
    camera.orthographic = orthographic;
    const View view = make_view(camera, 640, 480);
    const auto a = project(view, Vec3f(0, 0, 0));
    const auto b = project(view, Vec3f(0, 0.1f, 0));
    ASSERT_TRUE(a && b);
    EXPECT_NEAR((a->px - b->px).norm(), 0.1 * view.px_per_m_at_target, 1e-3);
  }
}

TEST(View, NothingBehindTheEyeIsProjected) {
  Camera camera;
  camera.eye = Vec3d(-1, 0, 0);
  const View view = make_view(camera, 640, 480);
  EXPECT_FALSE(project(view, Vec3f(-2, 0, 0)));
  EXPECT_FALSE(project(view, Vec3f(std::nanf(""), 0, 0)));
  EXPECT_TRUE(project(view, Vec3f(2, 0, 0)));
}

}  // namespace
}  // namespace planescope::render
