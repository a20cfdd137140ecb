#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "support/render_depth.hpp"

namespace planescope::planes {
namespace {

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

TEST(GravityEstimate, IsRightOnScenesThatRobotsMeet) {
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

TEST(GravityEstimate, ABareFloorIsTheGroundHoweverTheCameraIsTilted) {
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

TEST(GravityEstimate, AWallAloneDoesNotTell) {
  for (const double pitch_deg : {-10.0, 0.0, 20.0, 40.0})
    EXPECT_FALSE(
        estimate_gravity(render_depth({wall_ahead(1.5)}, {0.8, pitch_deg, 3, 0.06, 1}), {}))
        << pitch_deg;
}

TEST(GravityEstimate, TwoWallsOfACornerTellLittleButRightly) {
  const std::vector<Parallelogram> corner{wall_ahead(2),
                                          {Vec3d(-5, 1, -3), Vec3d(10, 0, 0), Vec3d(0, 0, 6)}};
  const Camera camera{0.8, 5, 4, 0.06, 1};
  const auto gravity = estimate_gravity(render_depth(corner, camera), {});
  ASSERT_TRUE(gravity.has_value());
  EXPECT_LT(angle_between_deg(gravity->direction, true_gravity(camera)), 2);
  EXPECT_LT(gravity->confidence, 0.4);
}

TEST(GravityEstimate, AnEmptyFrameDoesNotTell) {
  EXPECT_FALSE(estimate_gravity(render_depth({}, {}), {}).has_value());
}

TEST(GravityEstimate, HolesAndNonsenseDoNotDisturb) {
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
  Vec3d gravity;  // minus the normal of the floor in that frame
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
