// Tests of the camera model: rays, projection and distortion.

#include "core/planes/cloud/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace planescope::planes {
namespace {

Intrinsics test_camera() {
  Intrinsics k;
  k.width = 640;
  k.height = 480;
  k.fx = 575.9;
  k.fy = 576.4;
  k.cx = 315.2;
  k.cy = 230.6;
  k.coefficients = {-0.0451, 0.2395, -0.0096, -0.0029, -0.3148};
  return k;
}

TEST(Camera, WithoutDistortionAPixelIsItsPinholeRay) {
  const Intrinsics k = test_camera();
  const Vec2d ray = pixel_to_ray(k, 10, 20);
  EXPECT_DOUBLE_EQ(ray.x(), (10 - k.cx) / k.fx);
  EXPECT_DOUBLE_EQ(ray.y(), (20 - k.cy) / k.fy);
}

TEST(Camera, BrownConradyMatchesTheOpenCvFormula) {
  Intrinsics k = test_camera();
  k.distortion = Distortion::brown_conrady;
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const auto [k1, k2, p1, p2, k3] = k.coefficients;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const Vec2d pixel = ray_to_pixel(k, {x, y});
  EXPECT_NEAR(pixel.x(), k.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + k.cx, 1e-9);
  EXPECT_NEAR(pixel.y(), k.fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + k.cy, 1e-9);
}

TEST(Camera, EveryPixelIsRecoveredFromItsRay) {
  for (const Distortion model : {Distortion::brown_conrady, Distortion::inverse_brown_conrady}) {
    Intrinsics k = test_camera();
    k.distortion = model;
    double worst_px = 0;
    for (int v = 0; v < k.height; v += 7)
      for (int u = 0; u < k.width; u += 7) {
        const Vec2d ray = pixel_to_ray(k, u, v);
        ASSERT_TRUE(ray.allFinite()) << u << ' ' << v;
        worst_px = std::max(worst_px, (ray_to_pixel(k, ray) - Vec2d(u, v)).norm());
      }
    EXPECT_LT(worst_px, 1e-6);
  }
}

TEST(Camera, InverseBrownConradyUndoesBrownConradyOfTheSameName) {
  Intrinsics forward = test_camera(), inverse = test_camera();
  forward.distortion = Distortion::brown_conrady;
  inverse.distortion = Distortion::inverse_brown_conrady;
  const Vec2d ray(0.21, 0.13);
  const Vec2d distorted = ray_to_pixel(forward, ray);
  // The inverse model's pixel_to_ray uses the polynomial of the forward model.
  const Vec2d again =
      pixel_to_ray(inverse, forward.fx * ray.x() + forward.cx, forward.fy * ray.y() + forward.cy);
  EXPECT_NEAR(again.x() * forward.fx + forward.cx, distorted.x(), 1e-9);
  EXPECT_NEAR(again.y() * forward.fy + forward.cy, distorted.y(), 1e-9);
}

TEST(Camera, APixelWithoutARayIsNaN) {
  Intrinsics k = test_camera();
  k.distortion = Distortion::brown_conrady;
  // The calibration of a real camera (its k3 is valid only where the targets were), which folds
  // back in the image's corners.
  k.coefficients = {-0.0451, 0.2395, -0.0096, -0.0029, -1.0148};
  EXPECT_TRUE(std::isnan(pixel_to_ray(k, 0, 0).x()));
  EXPECT_TRUE(pixel_to_ray(k, 300, 220).allFinite());
}

}  // namespace
}  // namespace planescope::planes
