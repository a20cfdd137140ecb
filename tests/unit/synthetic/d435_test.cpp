#include "core/synthetic/d435.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/synthetic/test_scenes.hpp"

namespace planescope {
namespace {

using namespace synthetic_test;

struct Spread {
  double mean_m = 0, deviation_m = 0;
};

/// Of the measured depths right of the invalid band.
Spread spread(const Frame& frame) {
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
    const Spread measured = spread(seen(wall_at(z), model));
    EXPECT_NEAR(measured.mean_m, z, 0.002) << z;
    EXPECT_NEAR(measured.deviation_m / depth_sigma_m(model, z), 1, 0.06) << z;
    if (z == 0.5) at_half_m = measured.deviation_m;
    EXPECT_NEAR(measured.deviation_m / at_half_m, z * z / 0.25, 0.08 * z * z / 0.25) << z;
  }
  // The size that is published for the real camera: some millimetres at 1 m.
  EXPECT_NEAR(depth_sigma_m(model, 1.0), 0.004, 0.001);
}

TEST(D435, NeighbouringPixelsErrAlikeAndDistantOnesDoNot) {
  const double z = 1.2;
  const Frame frame = seen(wall_at(z), without_color());
  const auto correlation = [&](int lag) {
    double products = 0, squares = 0;
    for (int y = 0; y < 480; ++y) {
      for (int x = 100; x + lag < 640; ++x) {
        if (frame.depth.at(x, y) == 0 || frame.depth.at(x + lag, y) == 0) continue;
        const double a = frame.depth.at(x, y) * 0.001 - z;
        const double b = frame.depth.at(x + lag, y) * 0.001 - z;
        products += a * b;
        squares += a * a;
      }
    }
    return products / squares;
  };
  EXPECT_GT(correlation(1), 0.6);
  EXPECT_GT(correlation(2), 0.3);
  EXPECT_LT(std::abs(correlation(12)), 0.05);
}

TEST(D435, DepthComesInStepsOfDisparity) {
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

TEST(D435, BackgroundLeftOfAnObjectIsLostWhereOnlyTheLeftImagerSeesIt) {
  Scene scene = wall_at(1.6);
  // A plate 0.8 m away whose edges lie at pixels 319.5 -+ 0.2 / 0.8 * 385.
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
}  // namespace planescope
