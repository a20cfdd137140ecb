#include "core/planes/cloud/gravity.hpp"

#include <gtest/gtest.h>

#include "core/model/error.hpp"

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

TEST(Gravity, BadOptionsAreRefusedByName) {
  for (const char* text : {"", "down", "1,2", "1,2,3,4", "0,0,0", "1;2;3", "1,2,x", "nan,0,0"}) {
    try {
      parse_gravity(text);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
}

TEST(Gravity, TheOptionWinsOverTheRecording) {
  Frame frame = empty_depth();
  frame.gravity = from_file(GravitySource::imu, {0, 0, 1});
  const Gravity gravity = resolve_gravity(frame, parse_gravity("0,3,4"));
  EXPECT_EQ(gravity.source, GravitySource::option);
  EXPECT_TRUE(gravity.direction.isApprox(Vec3d(0, 0.6, 0.8)));
}

TEST(Gravity, TheRecordingWinsOverTheScene) {
  Frame frame = empty_depth();
  frame.gravity = from_file(GravitySource::sidecar, {0, 1, 0});
  EXPECT_EQ(resolve_gravity(frame, {}).source, GravitySource::sidecar);
}

TEST(Gravity, AskingForTheImuOfARecordingWithoutOneIsAnError) {
  Frame frame = empty_depth();
  EXPECT_THROW(resolve_gravity(frame, parse_gravity("imu")), Error);
  frame.gravity = from_file(GravitySource::imu, {0, 1, 0});
  EXPECT_EQ(resolve_gravity(frame, parse_gravity("imu")).source, GravitySource::imu);
}

TEST(Gravity, AFrameThatDoesNotTellIsRefusedWithAWayOut) {
  try {
    resolve_gravity(empty_depth(), {});
    FAIL();
  } catch (const Error& error) {
    for (const char* way : {"--gravity X,Y,Z", "planescope view", "--gravity none"})
      EXPECT_NE(std::string(error.what()).find(way), std::string::npos) << way;
  }
}

TEST(Gravity, NoneGoesWithoutWhateverTheRecordingSays) {
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

TEST(Gravity, WhoeverCanGoWithoutIsNotRefused) {
  for (const char* text : {"auto", "imu", "estimate"}) {
    GravityOptions options = parse_gravity(text);
    options.none_where_unknown = true;
    const Gravity gravity = resolve_gravity(empty_depth(), options);
    EXPECT_EQ(gravity.source, GravitySource::none) << text;
    EXPECT_FALSE(gravity.note.empty()) << text;
  }
}

TEST(Gravity, CloudsFallAlongMinusZUnlessTold) {
  Frame frame;
  frame.cloud.emplace();
  EXPECT_EQ(resolve_gravity(frame, {}).direction, Vec3d(0, 0, -1));
  EXPECT_EQ(resolve_gravity(frame, {}).source, GravitySource::assumed);
  EXPECT_EQ(resolve_gravity(frame, parse_gravity("1,0,0")).direction, Vec3d(1, 0, 0));
  EXPECT_THROW(resolve_gravity(frame, parse_gravity("estimate")), Error);
}

}  // namespace
}  // namespace planescope::planes
