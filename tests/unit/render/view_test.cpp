#include "render/view.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace planescope::render {
namespace {

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
