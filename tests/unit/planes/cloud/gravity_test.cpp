// Tests of gravity: options, priority of sources, and estimation from the scene.

#include "core/planes/cloud/gravity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "support/render_depth.hpp"

namespace planescope::planes {
namespace {

Frame empty_depth() {
  Frame frame;
  frame.name = "empty";
  frame.depth = Image16(64, 48, 1, 0);
  frame.depth_unit_m = 0.001;
  frame.intrinsics.width = 64;
  frame.intrinsics.height = 48;
  frame.intrinsics.fx = frame.intrinsics.fy = 40;
  frame.intrinsics.cx = 32;
  frame.intrinsics.cy = 24;
  return frame;
}

Frame measured_once() {
  Frame frame = empty_depth();
  frame.depth.data[100] = 900;
  return frame;
}

Gravity from_file(GravitySource source, const Vec3d& direction) {
  Gravity gravity;
  gravity.direction = direction;
  gravity.source = source;
  return gravity;
}

TEST(Gravity, OptionsAreParsed) {
  EXPECT_EQ(parse_gravity("auto").mode, GravityMode::automatic);
  EXPECT_EQ(parse_gravity("imu").mode, GravityMode::imu);
  EXPECT_EQ(parse_gravity("estimate").mode, GravityMode::estimate);
  const GravityOptions fixed = parse_gravity("-0.323,0.844,0.428");
  EXPECT_EQ(fixed.mode, GravityMode::fixed);
  EXPECT_EQ(fixed.direction, Vec3d(-0.323, 0.844, 0.428));
  EXPECT_EQ(parse_gravity("0, 0, -1").direction, Vec3d(0, 0, -1));
}

TEST(Gravity, InvalidOptionsAreRejectedByName) {
  for (const char* text : {"", "down", "1,2", "1,2,3,4", "0,0,0", "1;2;3", "1,2,x", "nan,0,0"}) {
    try {
      parse_gravity(text);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
}

TEST(Gravity, TheOptionOverridesTheRecording) {
  Frame frame = empty_depth();
  frame.gravity = from_file(GravitySource::imu, {0, 0, 1});
  const Gravity gravity = resolve_gravity(frame, parse_gravity("0,3,4"));
  EXPECT_EQ(gravity.source, GravitySource::option);
  EXPECT_TRUE(gravity.direction.isApprox(Vec3d(0, 0.6, 0.8)));
}

TEST(Gravity, TheRecordingOverridesTheScene) {
  Frame frame = empty_depth();
  frame.gravity = from_file(GravitySource::sidecar, {0, 1, 0});
  EXPECT_EQ(resolve_gravity(frame, {}).source, GravitySource::sidecar);
}

TEST(Gravity, RequestingAMissingImuIsAnError) {
  Frame frame = empty_depth();
  EXPECT_THROW(resolve_gravity(frame, parse_gravity("imu")), Error);
  frame.gravity = from_file(GravitySource::imu, {0, 1, 0});
  EXPECT_EQ(resolve_gravity(frame, parse_gravity("imu")).source, GravitySource::imu);
}

TEST(Gravity, AFrameWithoutAnEstimateIsRejectedWithASuggestion) {
  try {
    resolve_gravity(measured_once(), {});
    FAIL();
  } catch (const Error& error) {
    for (const char* way : {"--gravity X,Y,Z", "planescope view", "--gravity none"})
      EXPECT_NE(std::string(error.what()).find(way), std::string::npos) << way;
  }
}

std::string why_refused(const Frame& frame, double max_range_m = 0) {
  try {
    resolve_gravity(frame, {}, max_range_m);
  } catch (const Error& error) {
    return error.what();
  }
  return "it was not";
}

TEST(Gravity, ADepthImageWithoutDepthIsReportedAsSuch) {
  EXPECT_EQ(why_refused(empty_depth()), "frame empty: contains no depth: all pixels are 0");
}

TEST(Gravity, AWrongDepthUnitIsSuspectedIfEverythingIsOutOfRange) {
  Frame frame = measured_once();
  frame.depth_unit_m = 1;
  EXPECT_EQ(why_refused(frame, 4),
            "frame empty: all depths are between 900 and 900 m, beyond --max-range 4 m: is "
            "--depth-unit 1 correct?");
  frame.depth_unit_m = 0.001;
  EXPECT_EQ(why_refused(frame, 4).find("--depth-unit"), std::string::npos);
}

TEST(Gravity, NoneIgnoresTheRecordingsGravity) {
  EXPECT_EQ(parse_gravity("none").mode, GravityMode::none);
  Frame frame = empty_depth();
  frame.gravity = from_file(GravitySource::imu, {0, 0, 1});
  const Gravity gravity = resolve_gravity(frame, parse_gravity("none"));
  EXPECT_FALSE(gravity.known());
  EXPECT_EQ(gravity.source, GravitySource::none);
  EXPECT_EQ(gravity.confidence, 0);
  EXPECT_EQ(gravity.direction, Vec3d(0, 1, 0)) << "the lower edge of the image";
  frame.cloud.emplace();
  EXPECT_EQ(resolve_gravity(frame, parse_gravity("none")).direction, Vec3d(0, 0, -1));
}

TEST(Gravity, CallersThatWorkWithoutItGetNoError) {
  for (const char* text : {"auto", "imu", "estimate"}) {
    GravityOptions options = parse_gravity(text);
    options.none_where_unknown = true;
    const Gravity gravity = resolve_gravity(empty_depth(), options);
    EXPECT_EQ(gravity.source, GravitySource::none) << text;
    EXPECT_FALSE(gravity.note.empty()) << text;
  }
}

TEST(Gravity, CloudsHaveGravityMinusZByDefault) {
  Frame frame;
  frame.cloud.emplace();
  EXPECT_EQ(resolve_gravity(frame, {}).direction, Vec3d(0, 0, -1));
  EXPECT_EQ(resolve_gravity(frame, {}).source, GravitySource::assumed);
  EXPECT_EQ(resolve_gravity(frame, parse_gravity("1,0,0")).direction, Vec3d(1, 0, 0));
  EXPECT_THROW(resolve_gravity(frame, parse_gravity("estimate")), Error);
}

const Vec3d kDown = Vec3d(0.2, 0.9, 0.3).normalized();

/// A wall in a world with gravity kDown, rotated about it by an angle.
Vec3d wall(double turned_deg) {
  const Vec3d across = kDown.cross(Vec3d::UnitZ()).normalized(), along = across.cross(kDown);
  const double angle = turned_deg * std::numbers::pi / 180;
  return std::cos(angle) * across + std::sin(angle) * along;
}

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::min(1.0, a.dot(b))) * 180 / std::numbers::pi;
}

TEST(GravityPick, AFloorDefinesItByItsNormal) {
  EXPECT_TRUE(gravity_of_floor(-2 * kDown).isApprox(kDown));
}

TEST(GravityPick, OneWallRotatesKnownGravityIntoTheWall) {
  const Vec3d known = (kDown + 0.2 * wall(0) + 0.1 * wall(90)).normalized();
  const std::vector<Vec3d> walls = {wall(0)};
  const auto gravity = gravity_of_walls(walls, known);
  ASSERT_TRUE(gravity);
  EXPECT_NEAR(gravity->dot(wall(0)), 0, 1e-12);
  EXPECT_NEAR(gravity->norm(), 1, 1e-12);
  EXPECT_LT(angle_deg(*gravity, kDown), angle_deg(known, kDown));
}

TEST(GravityPick, TwoWallsDefineItRegardlessOfKnownGravity) {
  // The known gravity is 40 degrees off; it only determines the sign.
  const Vec3d known = (kDown + 0.8 * wall(30)).normalized();
  for (const double corner_deg : {30.0, 90.0, -75.0}) {
    const std::vector<Vec3d> walls = {wall(10), wall(10 + corner_deg)};
    const auto gravity = gravity_of_walls(walls, known);
    ASSERT_TRUE(gravity) << corner_deg;
    EXPECT_LT(angle_deg(*gravity, kDown), 1e-5) << corner_deg;
  }
}

TEST(GravityPick, MoreWallsAreCombined) {
  const auto leaning = [](double turned_deg, double lean) {
    return Vec3d(wall(turned_deg) + lean * kDown).normalized();
  };
  const std::vector<Vec3d> walls = {leaning(0, 0.03), leaning(180, 0.03), leaning(90, 0)};
  const auto gravity = gravity_of_walls(walls, kDown);
  ASSERT_TRUE(gravity);
  EXPECT_LT(angle_deg(*gravity, kDown), 0.1) << "opposite walls that lean alike cancel";
}

TEST(GravityPick, ParallelWallsAndFloorsAsWallsAreRejectedWithAReason) {
  std::string why;
  const std::vector<Vec3d> parallel = {wall(0), wall(185)};
  EXPECT_FALSE(gravity_of_walls(parallel, kDown, &why));
  EXPECT_NE(why.find("parallel"), std::string::npos) << why;
  const std::vector<Vec3d> floor = {Vec3d(-kDown + 0.3 * wall(0)).normalized()};
  EXPECT_FALSE(gravity_of_walls(floor, kDown, &why));
  EXPECT_NE(why.find("floor"), std::string::npos) << why;
  EXPECT_FALSE(gravity_of_walls({}, kDown));
}

using test::add_box;
using test::angle_between_deg;
using test::Camera;
using test::Parallelogram;
using test::render_depth;
using test::true_gravity;

Parallelogram floor_plane() { return {Vec3d(-5, -5, 0), Vec3d(10, 0, 0), Vec3d(0, 10, 0)}; }
Parallelogram wall_ahead(double x) { return {Vec3d(x, -5, -3), Vec3d(0, 10, 0), Vec3d(0, 0, 6)}; }

std::vector<Parallelogram> staircase() {
  std::vector<Parallelogram> scene{floor_plane()};
  for (int step = 0; step < 4; ++step)
    add_box(scene, Vec3d(0.9 + 0.28 * step, -0.6, 0), Vec3d(0.28, 1.2, 0.16 * (step + 1)), 0.2);
  return scene;
}

std::vector<Parallelogram> ramp(double angle_deg) {
  const double a = angle_deg * std::numbers::pi / 180;
  return {floor_plane(),
          {Vec3d(0.9, -0.7, 0), Vec3d(0, 1.4, 0), Vec3d(1.5 * std::cos(a), 0, 1.5 * std::sin(a))}};
}

void expect_found(const std::vector<Parallelogram>& scene, const Camera& camera) {
  const auto gravity = estimate_gravity(render_depth(scene, camera), {});
  ASSERT_TRUE(gravity.has_value());
  EXPECT_LT(angle_between_deg(gravity->direction, true_gravity(camera)), 2)
      << gravity->direction.transpose();
  EXPECT_EQ(gravity->source, GravitySource::estimate);
  EXPECT_FALSE(gravity->note.empty());
}

TEST(GravityEstimate, IsCorrectOnTypicalRobotScenes) {
  std::vector<Parallelogram> kerb{floor_plane()};
  add_box(kerb, Vec3d(1.1, -5, 0), Vec3d(4, 10, 0.12));
  std::vector<Parallelogram> boxes{floor_plane()};
  add_box(boxes, Vec3d(0.9, -0.5, 0), Vec3d(0.3, 0.4, 0.25), 0.4);
  add_box(boxes, Vec3d(1.5, 0.1, 0), Vec3d(0.4, 0.3, 0.4), -0.7);
  const std::vector<Parallelogram> room{floor_plane(), wall_ahead(2)};
  std::uint64_t seed = 1;
  for (const auto& scene : {staircase(), kerb, boxes, room, ramp(10), ramp(20)})
    for (const auto& [pitch_deg, roll_deg] : {std::pair{20.0, -6.0}, {32.0, 0.0}, {45.0, 5.0}}) {
      SCOPED_TRACE(seed);
      expect_found(scene, {0.8, pitch_deg, roll_deg, 0.08, seed++});
    }
}

TEST(GravityEstimate, ABareFloorIsTheGroundForAnyCameraTilt) {
  expect_found({floor_plane()}, {0.8, 40, 0, 0.06, 1});
  expect_found({floor_plane()}, {0.8, 20, 40, 0.06, 2});
  const auto gravity = estimate_gravity(render_depth({floor_plane()}, {0.8, 40, 0, 0.06, 3}), {});
  ASSERT_TRUE(gravity.has_value());
  EXPECT_LE(gravity->confidence, 0.4) << "one plane could as well be something else";
}

TEST(GravityEstimate, AFloorBeyondTheTiltLimitIsNotTheGround) {
  const Frame frame = render_depth({floor_plane()}, {0.8, 40, 0, 0.06, 1});
  GravityOptions options;
  options.max_tilt_deg = 30;
  EXPECT_FALSE(estimate_gravity(frame, options).has_value());
}

TEST(GravityEstimate, AWallAloneGivesNoEstimate) {
  for (const double pitch_deg : {-10.0, 0.0, 20.0, 40.0})
    EXPECT_FALSE(
        estimate_gravity(render_depth({wall_ahead(1.5)}, {0.8, pitch_deg, 3, 0.06, 1}), {}))
        << pitch_deg;
}

TEST(GravityEstimate, TwoWallsOfACornerGiveAnUncertainButCorrectEstimate) {
  const std::vector<Parallelogram> corner{wall_ahead(2),
                                          {Vec3d(-5, 1, -3), Vec3d(10, 0, 0), Vec3d(0, 0, 6)}};
  const Camera camera{0.8, 5, 4, 0.06, 1};
  const auto gravity = estimate_gravity(render_depth(corner, camera), {});
  ASSERT_TRUE(gravity.has_value());
  EXPECT_LT(angle_between_deg(gravity->direction, true_gravity(camera)), 2);
  EXPECT_LT(gravity->confidence, 0.4);
}

TEST(Gravity, APlaneFacingTheCameraIsNeverGuessed) {
  for (const double pitch_deg : {90.0, 80.0}) {  // facing a floor
    const std::vector<Parallelogram> floor{{{-3, -3, 0}, {6, 0, 0}, {0, 6, 0}}};
    const std::string why = why_refused(render_depth(floor, {0.8, pitch_deg}));
    EXPECT_NE(why.find("a wall straight ahead (--gravity 0,1,0)"), std::string::npos) << why;
    EXPECT_NE(why.find("looks down (--gravity 0,0,1)"), std::string::npos) << why;
  }
  const std::vector<Parallelogram> wall{{{1, -3, -3}, {0, 6, 0}, {0, 0, 6}}};
  const std::string why = why_refused(render_depth(wall, {0.8, 0}));
  EXPECT_NE(why.find("one plane faces the camera"), std::string::npos) << why;
}

TEST(GravityEstimate, AnEmptyFrameGivesNoEstimate) {
  EXPECT_FALSE(estimate_gravity(render_depth({}, {}), {}).has_value());
}

TEST(GravityEstimate, HolesAndInvalidPixelsDoNotDisturbIt) {
  const Camera camera{0.8, 30, 0, 0.06, 5};
  Frame frame = render_depth(staircase(), camera);
  for (std::size_t i = 0; i < frame.depth.data.size(); i += 11) frame.depth.data[i] = 65535;
  for (std::size_t i = 0; i < frame.depth.data.size(); i += 13) frame.depth.data[i] = 0;
  const auto gravity = estimate_gravity(frame, {});
  ASSERT_TRUE(gravity.has_value());
  EXPECT_LT(angle_between_deg(gravity->direction, true_gravity(camera)), 2);
}

TEST(GravityEstimate, IsWithinTwoDegreesOnEveryFrameOfTheSample) {
  const std::filesystem::path path = PLANESCOPE_SOURCE_DIR "/assets/sample";
  const auto sample = io::open_recording(path);
  ASSERT_GT(sample->frame_count(), 0);
  for (int i = 0; i < sample->frame_count(); ++i) {
    const auto truth = labels::read_frame_labels(labels::default_label_dir(path), i, "");
    ASSERT_TRUE(truth.has_value()) << i;
    const auto estimate = estimate_gravity(sample->frame(i), {});
    ASSERT_TRUE(estimate.has_value()) << i;
    EXPECT_LT(angle_between_deg(estimate->direction, truth->gravity.direction), 2) << i;
  }
}

struct Known {
  const char* path;
  std::optional<std::array<double, 4>> intrinsics;
  int frame;
  Vec3d gravity;  // negative normal of the floor in that frame
};

TEST(GravityEstimate, AgreesWithTheFloorOfRealRecordings) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const std::array<double, 4> aims{383.8, 383.8, 321.7, 236.8};
  for (const Known& known : {Known{"felixchenfy_d4xx_640x480", {}, 0, {-0.323, 0.844, 0.428}},
                             Known{"felixchenfy_d4xx_640x480", {}, 2, {-0.006, 0.966, 0.259}},
                             Known{"felixchenfy_d4xx_640x480", {}, 3, {-0.059, 0.996, 0.066}},
                             Known{"aims_slam_realsense_640x480", aims, 0, {0.177, 0.922, 0.345}},
                             Known{"polylidar_d435i_424x240", {}, 3, {0.011, 0.861, 0.508}}}) {
    io::RecordingOptions options;
    options.intrinsics = known.intrinsics;
    const auto recording = io::open_recording(std::filesystem::path(data) / known.path, options);
    const Gravity gravity = resolve_gravity(recording->frame(known.frame), {});
    EXPECT_LT(angle_between_deg(gravity.direction, known.gravity), 3)
        << known.path << " frame " << known.frame << ": " << gravity.direction.transpose();
  }
}

}  // namespace
}  // namespace planescope::planes
