// Tests of the evaluation sets: reproducible frames, and truth that agrees with geometry.

#include "core/lab/synthetic/evaluation_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/lab/bench/stairs_bench.hpp"
#include "core/lab/experiments/contest.hpp"
#include "core/lab/synthetic/d435.hpp"
#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/model/error.hpp"
#include "unit/lab/synthetic/test_scenes.hpp"

namespace planescope::lab {
namespace {

// ---- Clouds ----

EvaluationOptions small() {
  EvaluationOptions options;
  options.points = 1000;
  return options;
}

EvaluationFrame make(const std::string& set, int index, const EvaluationOptions& options) {
  return make_evaluation_frame(find_evaluation_set(set), index, options);
}

std::vector<std::string> names(bool depth) {
  std::vector<std::string> names;
  for (const EvaluationSet& set : evaluation_sets())
    if (set.depth == depth) names.push_back(set.name);
  return names;
}

int largest_plane(const EvaluationFrame& frame) {
  int largest = 0;
  for (const TruePolygon& polygon : frame.polygons) largest = std::max(largest, polygon.plane);
  return largest;
}

/// Distance of a point to the nearest part of its plane; with `but`, to the nearest other plane.
double distance_to_plane(const EvaluationFrame& frame,
                         int plane,
                         const Vec3f& p,
                         bool but = false) {
  double nearest = 1e300;
  for (const TruePolygon& polygon : frame.polygons)
    if ((polygon.plane == plane) != but)
      nearest = std::min(nearest, distance_m(polygon, p.cast<double>()));
  return nearest;
}

TEST(EvaluationSets, UnknownOnesAreRejectedWithAListOfNames) {
  try {
    find_evaluation_set("cookies");
    FAIL();
  } catch (const Error& error) {
    const std::string line = error.what();
    for (const EvaluationSet& set : evaluation_sets())
      EXPECT_NE(line.find(set.name), std::string::npos) << line;
  }
  EXPECT_THROW(parse_depth_errors("much"), Error);
  EXPECT_EQ(parse_depth_errors("d435"), DepthErrors::d435);
}

TEST(EvaluationSets, StairsMatchThePaper) {
  EvaluationOptions options = small();
  options.seed = 7;
  options.noise_m = 0.01;
  StairsOptions same;
  same.seed = 7;
  same.points = options.points;
  same.noise_m = 0.01;
  const Stairs stairs = make_stairs(5, same);
  const EvaluationFrame frame = make("stairs", 5, options);
  EXPECT_EQ(frame.name, "stairs_005");
  EXPECT_EQ(frame.frame.cloud->points, stairs.cloud.points);
  EXPECT_EQ(frame.frame.cloud->instance, stairs.cloud.instance);
  EXPECT_EQ(frame.normals, stairs.normals);
  EXPECT_EQ(largest_plane(frame), 2 * stairs.steps);
}

class EveryCloudSet : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(EvaluationSets,
                         EveryCloudSet,
                         testing::ValuesIn(names(false)),
                         [](const auto& set) { return set.param; });

TEST_P(EveryCloudSet, HasTheSamePointsInAnyOrderOfRequests) {
  const EvaluationFrame alone = make(GetParam(), 2, small());
  make(GetParam(), 0, small());
  make(GetParam(), 1, small());
  const EvaluationFrame again = make(GetParam(), 2, small());
  EXPECT_EQ(alone.frame.cloud->points, again.frame.cloud->points);
  EXPECT_EQ(alone.frame.cloud->instance, again.frame.cloud->instance);
  EXPECT_NE(alone.frame.cloud->points, make(GetParam(), 3, small()).frame.cloud->points);
}

TEST_P(EveryCloudSet, PutsPointsWithoutNoiseOnAPolygonOfTheirPlane) {
  for (int index = 0; index < 6; ++index) {
    const EvaluationFrame frame = make(GetParam(), index, small());
    const PointSet& cloud = *frame.frame.cloud;
    ASSERT_EQ(cloud.points.size(), 1000U);
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      EXPECT_LT(distance_to_plane(frame, cloud.instance[i], cloud.points[i]), 1e-6);
  }
}

TEST_P(EveryCloudSet, IsSolvedByTheOracleAwayFromEdges) {
  for (int index = 0; index < 6; ++index) {
    const EvaluationFrame frame = make(GetParam(), index, small());
    const PointSet& cloud = *frame.frame.cloud;
    const std::vector<std::int32_t> planes = oracle_planes(cloud.points, frame.polygons);
    int compared = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (distance_to_plane(frame, cloud.instance[i], cloud.points[i], true) < 1e-4) continue;
      EXPECT_EQ(planes[i], cloud.instance[i]);
      ++compared;
    }
    EXPECT_GT(compared, 900);
  }
}

TEST_P(EveryCloudSet, HasConsistentPlanesNormalsAndGravity) {
  for (int index = 0; index < 12; ++index) {
    const EvaluationFrame frame = make(GetParam(), index, small());
    const int planes = largest_plane(frame);
    EXPECT_EQ(static_cast<int>(frame.normals.size()), planes);
    std::set<int> seen;
    for (const std::int32_t plane : frame.frame.cloud->instance)
      if (plane > 0) seen.insert(plane);
    EXPECT_EQ(static_cast<int>(seen.size()), planes) << "every plane has points";
    for (const TruePolygon& polygon : frame.polygons) {
      if (polygon.plane == 0) continue;
      const Vec3d& normal = frame.normals[polygon.plane - 1];
      EXPECT_NEAR(normal.norm(), 1, 1e-9);
      for (const Vec3d& corner : polygon.corners)
        EXPECT_NEAR(normal.dot(corner - polygon.corners[0]), 0, 1e-9);
    }
    ASSERT_TRUE(frame.frame.gravity);
    EXPECT_EQ(frame.frame.gravity->direction, Vec3d(0, 0, -1));
  }
}

TEST_P(EveryCloudSet, KeepsItsGeometryUnderNoise) {
  EvaluationOptions noisy = small();
  noisy.noise_m = 0.01;
  const EvaluationFrame clean = make(GetParam(), 0, small());
  const EvaluationFrame frame = make(GetParam(), 0, noisy);
  EXPECT_EQ(frame.frame.cloud->instance, clean.frame.cloud->instance);
  EXPECT_EQ(frame.normals, clean.normals);
  double squares = 0;
  for (std::size_t i = 0; i < frame.frame.cloud->points.size(); ++i)
    squares += (frame.frame.cloud->points[i] - clean.frame.cloud->points[i]).squaredNorm();
  EXPECT_NEAR(std::sqrt(squares / 3000), 0.01, 0.001);
}

struct PlaneCount {
  const char* set;
  int fewest, most;
};
TEST(EvaluationSets, ObjectsHaveTheDescribedPlanes) {
  for (const PlaneCount& expected :
       {PlaneCount{"side_walls", 6, 13},    // ground, 2 to 5 steps, one or two walls
        PlaneCount{"open_risers", 16, 31},  // ground, five faces per slab
        PlaneCount{"equal_boxes", 16, 41},  // ground, five faces per box
        PlaneCount{"ramps", 5, 6}, PlaneCount{"kerbs", 3, 4}, PlaneCount{"spiral", 8, 16}}) {
    std::set<int> counts;
    for (int index = 0; index < find_evaluation_set(expected.set).frames; ++index) {
      const int planes = largest_plane(make(expected.set, index, small()));
      EXPECT_GE(planes, expected.fewest) << expected.set;
      EXPECT_LE(planes, expected.most) << expected.set;
      counts.insert(planes);
    }
    EXPECT_GT(counts.size(), 1U) << expected.set;
  }
}

TEST(EvaluationSets, TopsOfEqualBoxesHaveOneHeightButAreSeparatePlanes) {
  const EvaluationFrame frame = make("equal_boxes", 0, small());
  std::set<int> tops;
  double height = 0;
  for (const TruePolygon& polygon : frame.polygons) {
    if (frame.normals[polygon.plane - 1].z() < 0.9 || polygon.corners[0].z() == 0) continue;
    if (tops.empty()) height = polygon.corners[0].z();
    EXPECT_EQ(polygon.corners[0].z(), height);
    tops.insert(polygon.plane);
  }
  EXPECT_GE(tops.size(), 3U);
}

TEST(EvaluationSets, ThePoleOfASpiralIsNotAPlane) {
  const PointSet cloud = *make("spiral", 0, small()).frame.cloud;
  EXPECT_GT(std::count(cloud.instance.begin(), cloud.instance.end(), 0), 10);
}

// ---- Depth images ----

using namespace synthetic_test;

EvaluationFrame make(const std::string& set, int index, DepthErrors errors) {
  EvaluationOptions options;
  options.errors = errors;
  return make_evaluation_frame(find_evaluation_set(set), index, options);
}

class EveryDepthSet : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(
    EvaluationSets,
    EveryDepthSet,
    testing::Values("depth_stairs", "depth_boxes", "depth_slopes", "depth_descent"),
    [](const auto& set) { return std::string(set.param); });

TEST_P(EveryDepthSet, ShowsAtLeastThreePlanesWithinRangeInEveryFrame) {
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

TEST_P(EveryDepthSet, HasTruthForEveryMeasuredPixelThatMatchesThePolygons) {
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

TEST_P(EveryDepthSet, KeepsGeometryAndTruthWithAnyErrors) {
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

TEST_P(EveryDepthSet, LevelPlanesArePerpendicularToItsGravity) {
  const EvaluationFrame frame = make(GetParam(), 0, DepthErrors::d435);
  const auto level =
      std::count_if(frame.normals.begin(), frame.normals.end(), [&](const Vec3d& normal) {
        return std::abs(normal.dot(frame.frame.gravity->direction) + 1) < 1e-9;
      });
  EXPECT_GE(level, 1);
  EXPECT_EQ(frame.frame.gravity->source, GravitySource::sidecar);
}

TEST(EvaluationDepth, PixelNoiseIsUncorrelatedAndAsStrongAsTheCameras) {
  const EvaluationFrame clean = make("depth_stairs", 0, DepthErrors::clean);
  const EvaluationFrame noisy = make("depth_stairs", 0, DepthErrors::noise);
  const D435Model model;
  double squares = 0, products = 0, count = 0, last = 0;
  for (std::size_t i = 0; i < clean.frame.depth.data.size(); ++i) {
    const double z = clean.frame.depth.data[i] * model.depth_unit_m;
    const double measured = noisy.frame.depth.data[i] * model.depth_unit_m;
    ASSERT_EQ(z > 0, measured > 0);
    if (z < 1) continue;  // at shorter range, rounding to counts is as large as the noise
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

TEST(EvaluationSets, StairsHaveTrueNosings) {
  for (const char* set : {"depth_stairs", "depth_descent"})
    for (int index = 0; index < 6; ++index) {
      SCOPED_TRACE(std::string(set) + ' ' + std::to_string(index));
      const EvaluationFrame frame = make(set, index, DepthErrors::clean);
      ASSERT_TRUE(frame.stairs);
      const TrueStairs& stairs = *frame.stairs;
      const Vec3d up = -frame.frame.gravity->direction;
      const auto height_of = [&](int plane) {
        for (const TruePolygon& polygon : frame.polygons)
          if (polygon.plane == plane) return up.dot(polygon.corners[0]);
        return std::nan("");
      };
      for (std::size_t i = 0; i < stairs.steps.size(); ++i) {
        const TrueStep& step = stairs.steps[i];
        EXPECT_NEAR((step.left - step.right).norm(), stairs.width_m, 1e-6);
        EXPECT_NEAR(height_of(step.tread) - height_of(step.before), stairs.rise_m, 1e-6);
        for (const Vec3d& corner : {step.right, step.left})
          EXPECT_LT(distance_to_plane(frame, step.tread, corner.cast<float>()), 1e-5);
        if (i == 0) continue;
        EXPECT_EQ(step.before, stairs.steps[i - 1].tread);
        const Vec3d uphill = (step.left - step.right).normalized().cross(up);
        EXPECT_NEAR(uphill.dot(step.right - stairs.steps[i - 1].right), stairs.going_m, 1e-6);
      }
    }
}

TEST(EvaluationSets, StepsCountAsVisibleIfMeasured) {
  for (const char* set : {"depth_stairs", "depth_descent"}) {
    int near_steps = 0;
    for (int index = 0; index < 6; ++index) {
      const EvaluationFrame frame = make(set, index, DepthErrors::clean);
      const std::vector<SeenStep> near = seen_steps(frame, 1.5), far = seen_steps(frame, 4);
      for (std::size_t i = 0; i < near.size(); ++i) {
        EXPECT_LE(near[i].tread_px, far[i].tread_px);
        EXPECT_LE(near[i].before_px, far[i].before_px);
      }
      near_steps += steps_in_sequence(near, kSeenPixels);
      EXPECT_LE(steps_in_sequence(near, kSeenPixels), steps_in_sequence(far, kSeenPixels));
    }
    EXPECT_GE(near_steps, 6) << set;
  }
  EXPECT_EQ(steps_in_sequence({{900, 900}, {900, 100}, {600, 700}, {500, 500}}, 500), 2);
}

}  // namespace

}  // namespace planescope::lab
