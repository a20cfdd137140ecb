// Tests of the D435 depth model: noise, quantization, holes and occlusion.

#include "core/lab/synthetic/d435.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/lab/synthetic/test_scenes.hpp"

namespace planescope::lab {
namespace {

using namespace synthetic_test;

struct DepthSpread {
  double mean_m = 0, deviation_m = 0;
};

/// Spread of the measured depths right of the invalid band.
DepthSpread spread(const Frame& frame) {
  double count = 0, sum = 0, squares = 0;
  for (int y = 0; y < frame.depth.height; ++y) {
    for (int x = 100; x < frame.depth.width; ++x) {
      const double z = frame.depth.at(x, y) * frame.depth_unit_m;
      if (z == 0) continue;
      count += 1;
      sum += z;
      squares += z * z;
    }
  }
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean)};
}

TEST(D435, DepthNoiseGrowsWithTheSquareOfDepth) {
  const D435Model model = without_color();
  double at_half_m = 0;
  for (const double z : {0.5, 1.0, 1.5, 2.0}) {
    const DepthSpread measured = spread(seen(wall_at(z), model));
    EXPECT_NEAR(measured.mean_m, z, 0.002) << z;
    EXPECT_NEAR(measured.deviation_m / depth_sigma_m(model, z), 1, 0.06) << z;
    if (z == 0.5) at_half_m = measured.deviation_m;
    EXPECT_NEAR(measured.deviation_m / at_half_m, z * z / 0.25, 0.08 * z * z / 0.25) << z;
  }
  // The published value for the real camera: several millimeters at 1 m.
  EXPECT_NEAR(depth_sigma_m(model, 1.0), 0.004, 0.001);
}

/// Correlation of the errors of pixels that are `lag` columns apart, on a wall at distance `z_m`.
double correlation(const Frame& frame, double z_m, int lag) {
  double products = 0, squares = 0;
  for (int y = 0; y < 480; ++y) {
    for (int x = 100; x + lag < 640; ++x) {
      if (frame.depth.at(x, y) == 0 || frame.depth.at(x + lag, y) == 0) continue;
      const double a = frame.depth.at(x, y) * 0.001 - z_m;
      const double b = frame.depth.at(x + lag, y) * 0.001 - z_m;
      products += a * b;
      squares += a * a;
    }
  }
  return products / squares;
}

TEST(D435, ErrorsOfNeighborsAreCorrelatedAndThoseOfDistantPixelsAreNot) {
  const Frame frame = seen(wall_at(1.2), without_color());
  EXPECT_GT(correlation(frame, 1.2, 1), 0.6);
  EXPECT_GT(correlation(frame, 1.2, 2), 0.3);
  EXPECT_LT(std::abs(correlation(frame, 1.2, 12)), 0.05);
}

TEST(D435, ABowIsCorrelatedOverItsLength) {
  D435Model model = without_color();
  model.disparity_sigma_px = 0;
  model.bow_sigma_px = 0.1;
  const Frame frame = seen(wall_at(1.2), model);
  const double error_m = 1.2 * 1.2 / (385 * 0.05) * 0.1;
  EXPECT_NEAR(spread(frame).deviation_m / error_m, 1, 0.2);
  EXPECT_GT(correlation(frame, 1.2, 12), 0.8);
  EXPECT_LT(std::abs(correlation(frame, 1.2, 2 * model.bow_px)), 0.3);
}

TEST(D435, FlyingPixelsAreBetweenSurfacesAlongTheirEdge) {
  Scene scene = wall_at(1.6);
  add_polygon(scene, {{0.8, 0.2, -9}, {0.8, -0.2, -9}, {0.8, -0.2, 9}, {0.8, 0.2, 9}}, {});
  const auto between = [&](double from, int x0, int x1) {
    D435Model model = without_color();
    model.flying_from = from;
    const Frame frame = seen(scene, model);
    int count = 0;
    for (int y = 0; y < 480; ++y)
      for (int x = x0; x < x1; ++x)
        count += frame.depth.at(x, y) > 900 && frame.depth.at(x, y) < 1400;
    return count;
  };
  const int edge = 416;  // 319.5 + 0.2 / 0.8 * 385
  EXPECT_EQ(between(D435Model{}.flying_from, 0, 640), 0);
  EXPECT_GT(between(0, edge - 4, edge + 4), 200);
  EXPECT_EQ(between(0, edge + 10, 640), 0);
}

TEST(D435, BlindPatchesAreNotMeasured) {
  D435Model model = without_color();
  model.blind_from = 0;  // half of the image
  EXPECT_NEAR(hole_share(seen(wall_at(1), model).depth, 100, 640, 0, 480), 0.5, 0.1);
}

TEST(D435, DepthIsQuantizedInDisparity) {
  D435Model model = without_color();
  model.depth_unit_m = 1e-5;  // fine enough to see the steps
  const Frame frame = seen(wall_at(0.5), model);
  int measured = 0;
  for (const std::uint16_t count : frame.depth.data) {
    if (count == 0) continue;
    ++measured;
    const double steps = 385 * 0.05 / (count * 1e-5) * 32;
    ASSERT_NEAR(steps, std::round(steps), 0.02);
  }
  EXPECT_GT(measured, 200000);
}

TEST(D435, TheLeftEdgeIsABandThatTheRightImagerMisses) {
  const Frame frame = seen(wall_at(0.5), without_color());
  const int band = 38;  // disparity 38.5 px
  EXPECT_EQ(hole_share(frame.depth, 0, band, 0, 480), 1);
  EXPECT_LT(hole_share(frame.depth, band + 1, 640, 0, 480), 0.01);
}

TEST(D435, BackgroundSeenOnlyByTheLeftImagerIsLost) {
  Scene scene = wall_at(1.6);
  // A plate at 0.8 m, with edges at pixels 319.5 -+ 0.2 / 0.8 * 385.
  add_polygon(scene, {{0.8, 0.2, -9}, {0.8, -0.2, -9}, {0.8, -0.2, 9}, {0.8, 0.2, 9}}, {});
  const Frame frame = seen(scene, without_color());
  const double jump = 385 * 0.05 * (1 / 0.8 - 1 / 1.6);  // 12 px
  const int left = 223, right = 416;
  EXPECT_EQ(hole_share(frame.depth, left - static_cast<int>(jump) + 1, left, 0, 480), 1);
  EXPECT_LT(hole_share(frame.depth, left - 40, left - 20, 0, 480), 0.02);
  EXPECT_LT(hole_share(frame.depth, left + 4, right - 4, 0, 480), 0.02);
  EXPECT_LT(hole_share(frame.depth, right + 5, right + 25, 0, 480), 0.02);
}

TEST(D435, SurfacesSeenAtAGrazingAngleDropOut) {
  const auto holes_of_floor = [](double height_m, double pitch_deg) {
    Scene scene;
    add_polygon(scene, {{-99, -99, 0}, {99, -99, 0}, {99, 99, 0}, {-99, 99, 0}}, {});
    scene.camera.position.z() = height_m;
    scene.camera.pitch_deg = pitch_deg;
    return hole_share(seen(scene, without_color()).depth, 200, 440, 235, 245);
  };
  EXPECT_LT(holes_of_floor(1, 60), 0.01);    // 30 degrees from the normal
  EXPECT_LT(holes_of_floor(0.3, 20), 0.05);  // 70 degrees
  EXPECT_GT(holes_of_floor(0.2, 5), 0.8);    // 85 degrees
}

TEST(D435, TooNearAndTooFarAreNotMeasured) {
  EXPECT_EQ(hole_share(seen(wall_at(0.14), without_color()).depth, 0, 640, 0, 480), 1);
  EXPECT_EQ(hole_share(seen(wall_at(16), without_color()).depth, 0, 640, 0, 480), 1);
}

TEST(D435, WithoutNoiseDepthIsExactToHalfACount) {
  D435Model model = without_color();
  model.noise = false;
  const Frame frame = seen(wall_at(1.2344), model);
  for (const std::uint16_t count : frame.depth.data) ASSERT_EQ(count, 1234);
}

}  // namespace
}  // namespace planescope::lab
