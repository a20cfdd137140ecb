#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/lab/synthetic/d435.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/lab/synthetic/render_scene.hpp"
#include "unit/lab/synthetic/test_scenes.hpp"

namespace planescope::lab {
namespace {

using namespace synthetic_test;

EvaluationFrame make(const std::string& set, int index, DepthErrors errors) {
  EvaluationOptions options;
  options.errors = errors;
  return make_evaluation_frame(find_evaluation_set(set), index, options);
}

class EveryDepthSet : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(EvaluationSets,
                         EveryDepthSet,
                         testing::Values("depth_stairs", "depth_boxes", "depth_slopes"),
                         [](const auto& set) { return std::string(set.param); });

TEST_P(EveryDepthSet, ShowsAtLeastThreePlanesWithinReachInEveryFrame) {
  for (int index = 0; index < find_evaluation_set(GetParam()).frames; ++index) {
    const EvaluationFrame frame = make(GetParam(), index, DepthErrors::clean);
    std::map<int, int> pixels;
    for (std::size_t i = 0; i < frame.frame.depth.data.size(); ++i) {
      const double z = frame.frame.depth.data[i] * frame.frame.depth_unit_m;
      if (z > 0 && z < 1.5) ++pixels[frame.labels->plane.data[i]];
    }
    const auto large = std::count_if(pixels.begin(), pixels.end(), [](const auto& entry) {
      return entry.first > 0 && entry.second >= 100;
    });
    EXPECT_GE(large, 3) << index;
  }
}

TEST_P(EveryDepthSet, CoversEveryMeasuredPixelWithTruthThatThePolygonsAgreeWith) {
  const EvaluationFrame frame = make(GetParam(), 1, DepthErrors::clean);
  const double rounding_m = 2 * frame.frame.depth_unit_m;
  for (int y = 0; y < frame.frame.depth.height; y += 7) {
    for (int x = 0; x < frame.frame.depth.width; x += 7) {
      if (frame.frame.depth.at(x, y) == 0) continue;
      const int plane = frame.labels->plane.at(x, y);
      ASSERT_GT(plane, 0);
      double nearest = 1e300;
      for (const TruePolygon& polygon : frame.polygons)
        if (polygon.plane == plane)
          nearest = std::min(nearest, distance_m(polygon, point_at(frame.frame, x, y)));
      EXPECT_LT(nearest, rounding_m) << x << ' ' << y;
    }
  }
}

TEST_P(EveryDepthSet, KeepsGeometryAndTruthWhateverTheErrors) {
  const EvaluationFrame clean = make(GetParam(), 2, DepthErrors::clean);
  for (const DepthErrors errors : {DepthErrors::noise, DepthErrors::d435}) {
    const EvaluationFrame frame = make(GetParam(), 2, errors);
    EXPECT_EQ(frame.normals, clean.normals);
    EXPECT_EQ(frame.labels->plane.data, clean.labels->plane.data);
    EXPECT_EQ(frame.frame.gravity->direction, clean.frame.gravity->direction);
    EXPECT_NE(frame.frame.depth.data, clean.frame.depth.data);
    EXPECT_EQ(frame.labels->depth_sha256, depth_sha256(frame.frame.depth));
  }
}

TEST_P(EveryDepthSet, LevelPlanesAreSquareToItsGravity) {
  const EvaluationFrame frame = make(GetParam(), 0, DepthErrors::d435);
  const auto level =
      std::count_if(frame.normals.begin(), frame.normals.end(), [&](const Vec3d& normal) {
        return std::abs(normal.dot(frame.frame.gravity->direction) + 1) < 1e-9;
      });
  EXPECT_GE(level, 1);
  EXPECT_EQ(frame.frame.gravity->source, GravitySource::sidecar);
}

TEST(EvaluationDepth, PixelNoiseLeavesNoHolesAndIsAsStrongAsTheCamerasWithoutItsCorrelation) {
  const EvaluationFrame clean = make("depth_stairs", 0, DepthErrors::clean);
  const EvaluationFrame noisy = make("depth_stairs", 0, DepthErrors::noise);
  const D435Model model;
  double squares = 0, products = 0, count = 0, last = 0;
  for (std::size_t i = 0; i < clean.frame.depth.data.size(); ++i) {
    const double z = clean.frame.depth.data[i] * model.depth_unit_m;
    const double measured = noisy.frame.depth.data[i] * model.depth_unit_m;
    ASSERT_EQ(z > 0, measured > 0);
    if (z < 1) continue;  // nearer, rounding to counts is as large as the noise
    const double error = (measured - z) / depth_sigma_m(model, z);
    squares += error * error;
    products += error * last;
    last = error;
    count += 1;
  }
  ASSERT_GT(count, 10000);
  EXPECT_NEAR(std::sqrt(squares / count), 1, 0.05);
  EXPECT_NEAR(products / squares, 0, 0.02);
}

TEST(EvaluationDepth, TheCameraModelLeavesHoles) {
  const Image16 depth = make("depth_stairs", 0, DepthErrors::d435).frame.depth;
  const Image16 clean = make("depth_stairs", 0, DepthErrors::clean).frame.depth;
  EXPECT_GT(std::count(depth.data.begin(), depth.data.end(), 0),
            std::count(clean.data.begin(), clean.data.end(), 0));
}

}  // namespace
}  // namespace planescope::lab
