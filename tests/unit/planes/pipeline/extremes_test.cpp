// Extreme options and points. Each gives a correct result or an error that names it; never a crash,
// NaN in a result, or unlimited memory.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "support/render_depth.hpp"

namespace planescope::planes {
namespace {

Frame room() {
  const test::Parallelogram floor{Vec3d(-5, -5, 0), Vec3d(10, 0, 0), Vec3d(0, 10, 0)};
  const test::Parallelogram wall{Vec3d(1.2, -5, -3), Vec3d(0, 10, 0), Vec3d(0, 0, 6)};
  return test::render_depth({floor, wall}, {0.5, 20, 0, 0, 1});
}

void expect_sound(const FrameResult& result) {
  const std::size_t planes = result.segmentation.planes.size();
  for (const PlaneRegion& plane : result.segmentation.planes) {
    EXPECT_TRUE(plane.fit.normal.allFinite());
    EXPECT_NEAR(plane.fit.normal.norm(), 1, 1e-9);
    EXPECT_TRUE(plane.fit.centroid.allFinite());
  }
  EXPECT_EQ(result.plane_of.size(), result.cloud.points.size());
  for (const std::int32_t id : result.plane_of) {
    EXPECT_GE(id, 0);
    EXPECT_LE(static_cast<std::size_t>(id), planes);
  }
}

class Extremes : public testing::TestWithParam<std::string> {};

TEST_P(Extremes, OfAnOptionAreAcceptedOrRejectedByName) {
  const OptionInfo& info = find_option(GetParam());
  const auto classifier = make_pca_classifier();
  const Frame frame = room();
  for (const char* value : {"0", "-1", "1e300", "-1e300", "nan", "inf", "99999999999999999999"}) {
    SCOPED_TRACE(info.name + "=" + value);
    PipelineOptions options;
    set_option(options, "classifier", "pca");
    try {
      set_option(options, info.name, value);
      expect_sound(run_frame(frame, options, classifier.get()));
    } catch (const Error& error) {
      const std::string reported = error.what();
      // Gravity cannot be estimated if almost no tilt is allowed.
      const bool of_gravity =
          info.section == "gravity" && reported.find("gravity") != std::string::npos;
      EXPECT_TRUE(of_gravity || reported.find(info.name) != std::string::npos) << reported;
      EXPECT_EQ(reported.find('\n'), std::string::npos) << reported;
    }
  }
}

std::vector<std::string> numbers() {
  std::vector<std::string> names;
  for (const OptionInfo& info : option_table())
    if (info.is_number() && (!info.method || *info.method == Method::ours))
      names.push_back(info.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, Extremes, testing::ValuesIn(numbers()), [](const auto& test) {
  return test.param;
});

/// A level patch of 2,000 points at `place`, with 1 cm spacing.
std::vector<Vec3d> patch(const Vec3d& place) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 2000; ++i)
    points.push_back(place + Vec3d(0.01 * (i % 50), 0.01 * (i / 50), 0));
  return points;
}

FrameResult planes_of(const std::vector<Vec3d>& points) {
  Frame frame;
  frame.name = "made";
  frame.depth_unit_m = 1;
  frame.cloud.emplace();
  frame.cloud->origin = bulk_origin(points);
  for (const Vec3d& point : points)
    frame.cloud->points.push_back((point - frame.cloud->origin).cast<float>());
  PipelineOptions options;
  set_option(options, "gravity", "0,0,-1");
  set_option(options, "classifier", "pca");
  return run_frame(frame, options, make_pca_classifier().get());
}

TEST(Numerics, APatchIsTheSamePlaneAtAnyDistance) {
  for (const double far_m : {0.0, 10.0, 1e3, 1e5, 1e7}) {
    SCOPED_TRACE(far_m);
    const FrameResult result = planes_of(patch(Vec3d(far_m, -far_m, far_m + 0.5)));
    expect_sound(result);
    ASSERT_EQ(result.segmentation.planes.size(), 1u);
    const PlaneFit& fit = result.segmentation.planes[0].fit;
    EXPECT_GT(std::abs(fit.normal.z()), std::cos(0.01 * M_PI / 180));
    const double z = (result.cloud.origin + fit.centroid).z();
    EXPECT_NEAR(z, far_m + 0.5, std::max(1e-5, 1e-9 * far_m));
    for (const std::int32_t id : result.plane_of) EXPECT_EQ(id, 1);
  }
}

TEST(Numerics, NonPlanarPointsGiveNoPlane) {
  std::vector<Vec3d> one{Vec3d(1, 2, 3)}, coincident(500, Vec3d(1, 2, 3)), collinear;
  for (int i = 0; i < 500; ++i) collinear.push_back(Vec3d(1, 2, 3) + 0.01 * i * Vec3d(1, 1, 0));
  for (const auto& points : {one, coincident, collinear}) {
    const FrameResult result = planes_of(points);
    expect_sound(result);
    EXPECT_TRUE(result.segmentation.planes.empty());
  }
}

TEST(Numerics, PointsOnTheBordersOfCellsAreFound) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) points.push_back(Vec3d(0.02 * i, 0.02 * j, 0.64));
  const FrameResult result = planes_of(points);
  ASSERT_EQ(result.segmentation.planes.size(), 1u);
  EXPECT_EQ(std::count(result.plane_of.begin(), result.plane_of.end(), 1), 3600);
}

TEST(Numerics, OutliersAndInvalidPointsDoNotAffectThePatch) {
  auto points = patch(Vec3d(1, 1, 1));
  const FrameResult alone = planes_of(points);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3d& stray :
       {Vec3d(1e7, 0, 0), Vec3d(0, -1e30, 0), Vec3d(nan, 0, 0), Vec3d(0, 0, 500)})
    points.push_back(stray);
  const FrameResult with = planes_of(points);
  expect_sound(with);
  ASSERT_EQ(with.segmentation.planes.size(), alone.segmentation.planes.size());
  std::size_t in_plane = 0;
  for (const std::int32_t id : with.plane_of) in_plane += id == 1;
  EXPECT_EQ(in_plane, 2000u);
}

}  // namespace
}  // namespace planescope::planes
