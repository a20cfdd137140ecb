// Tests of distances and angles between picked points and planes.

#include "core/debug/explain/measure.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "runs.hpp"

namespace planescope::debug {
namespace {

/// A frame whose sensor axes differ from the world's: x right, y down, z forward.
struct Measure : testing::Test {
  Subject subject;

  Measure() {
    Pose& pose = subject.prepared.cloud.T_world_sensor;
    pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    pose.translation() = Vec3d(0.2, -0.1, 1.3);
    subject.prepared.cloud.origin = Vec3d(3, 4, 5);
    subject.prepared.gravity = {Vec3d::UnitY(), GravitySource::option, 1, ""};
  }
  static MeasureEnd plane(const Vec3d& point,
                          const Vec3d& normal,
                          bool is_level,
                          const char* name) {
    return {point, normal.normalized(), is_level, name};
  }
};

TEST_F(Measure, BetweenTwoPointsIsDistanceHeightAndHorizontal) {
  const Measurement measured = measure(subject, {Vec3d(0, 1, 2)}, {Vec3d(0.3, 0.88, 2.16)});
  EXPECT_NEAR(measured.distance_m, std::hypot(0.34, 0.12), 1e-12);
  EXPECT_NEAR(measured.height_m.value(), 0.12, 1e-12);
  EXPECT_EQ(measured.text, "36.1 cm apart: 12.0 cm up, 34.0 cm across");
  EXPECT_NEAR((measured.corner - Vec3d(0.3, 1, 2.16)).norm(), 0, 1e-12);
  EXPECT_FALSE(measured.angle_deg);
  EXPECT_EQ(measure(subject, {Vec3d(0.3, 0.88, 2.16)}, {Vec3d(0, 1, 2)}).text,
            "36.1 cm apart: 12.0 cm down, 34.0 cm across");
}

TEST_F(Measure, FromAPlaneIsPerpendicularForEitherEnd) {
  const MeasureEnd floor = plane(Vec3d(9, 1, 9), -Vec3d::UnitY(), true, "P3");
  const MeasureEnd above{Vec3d(0.3, 0.88, 2)}, below{Vec3d(0.3, 1.05, 2)};
  for (const Measurement& measured :
       {measure(subject, floor, above), measure(subject, above, floor)}) {
    EXPECT_NEAR(measured.distance_m, 0.12, 1e-12);
    EXPECT_NEAR((measured.from - Vec3d(0.3, 1, 2)).norm(), 0, 1e-12);
    EXPECT_EQ(measured.text, "12.0 cm above P3: 12.0 cm up, 0.0 mm across");
  }
  EXPECT_EQ(measure(subject, floor, below).text, "5.0 cm below P3: 5.0 cm down, 0.0 mm across");
  const MeasureEnd wall = plane(Vec3d(0, 0, 2), -Vec3d::UnitZ(), false, "P1");
  EXPECT_EQ(measure(subject, wall, {Vec3d(0.5, 1, 1.75)}).text,
            "25.0 cm in front of P1: 0.0 mm up, 25.0 cm across");
  EXPECT_EQ(measure(subject, wall, {Vec3d(0.5, 1, 2.25)}).text,
            "25.0 cm behind P1: 0.0 mm up, 25.0 cm across");
}

TEST_F(Measure, BetweenTwoPlanesIsAStepAndAnAngle) {
  const MeasureEnd low = plane(Vec3d(0, 1, 1), -Vec3d::UnitY(), true, "P3");
  const double tilt = 2 * std::numbers::pi / 180;
  const MeasureEnd high =
      plane(Vec3d(0.1, 0.83, 1.3), Vec3d(0, -std::cos(tilt), std::sin(tilt)), true, "P5");
  const Measurement measured = measure(subject, low, high);
  EXPECT_NEAR(measured.height_m.value(), 0.17, 1e-12);
  EXPECT_NEAR(measured.angle_deg.value(), 2, 1e-9);
  EXPECT_EQ(measured.text, "P5 17.0 cm above P3: 17.0 cm up, 0.0 mm across, at an angle of 2.0°");
  EXPECT_EQ(measured.label, "17.0 cm, 2.0°");
  EXPECT_NEAR(
      measure(subject, low, plane(Vec3d::Zero(), -*high.normal, true, "P6")).angle_deg.value(), 2,
      1e-9)
      << "whichever way a normal looks";
}

TEST_F(Measure, TiltedPlanesAreMeasuredAtTheClickedPoint) {
  const MeasureEnd floor = plane(Vec3d(0, 1, 1), -Vec3d::UnitY(), true, "P3");
  const MeasureEnd wall = plane(Vec3d(0, 0.6, 2), -Vec3d::UnitZ(), false, "P1");
  EXPECT_EQ(measure(subject, floor, wall).text,
            "a point on P1 40.0 cm above P3: 40.0 cm up, 0.0 mm across, at an angle of 90.0°");
}

TEST_F(Measure, WithoutGravityHasNoHeight) {
  subject.prepared.gravity.source = GravitySource::none;
  const Measurement measured = measure(subject, {Vec3d(0, 1, 2)}, {Vec3d(0, 0, 2)});
  EXPECT_FALSE(measured.height_m);
  EXPECT_EQ(measured.text, "100.0 cm apart; gravity is unknown, so no heights");
}

TEST_F(Measure, EndsAreInSceneCoordinates) {
  const auto run =
      test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0.001, 0, 4096);
  const Subject& stairs = *run->subject;
  for (const std::size_t i : {std::size_t{0}, stairs.voxel_count() / 2}) {
    const Vec3f& at = stairs.prepared.voxels.points[i];
    EXPECT_NEAR((in_scene(stairs, measured_point(stairs, i).point) - at).norm(), 0, 1e-5);
    EXPECT_NEAR(
        (in_scene(stairs, measured_voxel(stairs, static_cast<std::uint32_t>(i)).point) - at).norm(),
        0, 1e-5);
    const std::int32_t plane =
        run->timeline.point_at(static_cast<std::int32_t>(i), run->steps()).plane;
    if (plane < 0) continue;
    const MeasureEnd point = measured_point(stairs, i);
    const MeasureEnd foot = measured_plane(*run, plane, run->steps(), &point);
    EXPECT_LT(std::abs(measure(stairs, foot, point).distance_m), 0.02);
    EXPECT_NEAR(measure(stairs, foot, point).distance_m,
                measure(stairs, measured_plane(*run, plane, run->steps()), point).distance_m, 1e-9);
  }
  EXPECT_THROW(measured_plane(*run, -1, run->steps()), Error);
  EXPECT_THROW(measured_plane(*run, 0, 0), Error) << "not founded yet";
}

}  // namespace
}  // namespace planescope::debug
