// Tests of gravity carried between the frames of a recording.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::world {
namespace {

constexpr int kBallFrames = 8;
constexpr double kStep_deg = 2;  // pitch and roll from frame to frame

Mat3d turned_by(double degrees, const Vec3d& axis) {
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()).toRotationMatrix();
}

Pose pose_at(int frame) {
  Pose pose = Pose::Identity();
  pose.linear() = turned_by(kStep_deg * frame, {1, 0, 0.5});
  pose.translation() = Vec3d(0.01 * frame, 0, 0);
  return pose;
}

/// Gravity is +y of the world, and no visible plane shows it: a camera turns among balls, or in
/// front of a bare wall.
class Balls : public io::Recording {
 public:
  std::set<int> empty;  // frames without depth
  std::map<int, Gravity> reported;
  bool poses = false, bare_wall = false;

  Balls() {
    info_.width = 160;
    info_.height = 120;
    info_.intrinsics_source = "test";
  }
  const io::RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return kBallFrames; }
  std::string frame_hash(int) const override { return ""; }
  std::optional<Pose> T_world_camera(int i) const override {
    return poses ? std::optional(pose_at(i)) : std::nullopt;
  }
  Frame frame(int i) const override {
    Frame frame;
    frame.index = i;
    frame.name = std::to_string(i);
    frame.depth_unit_m = 0.0005;
    frame.depth = Image16(info_.width, info_.height);
    frame.intrinsics.width = info_.width;
    frame.intrinsics.height = info_.height;
    frame.intrinsics.fx = frame.intrinsics.fy = 120;
    frame.intrinsics.cx = 80;
    frame.intrinsics.cy = 60;
    if (const auto known = reported.find(i); known != reported.end()) frame.gravity = known->second;
    if (empty.contains(i)) return frame;
    const Pose pose = bare_wall ? Pose::Identity() : pose_at(i);
    for (int v = 0; v < info_.height; ++v)
      for (int u = 0; u < info_.width; ++u) {
        const Vec3d ray = pose.linear() * Vec3d((u - 80) / 120.0, (v - 60) / 120.0, 1);
        frame.depth.at(u, v) =
            static_cast<std::uint16_t>(std::lround(depth_m(pose.translation(), ray) / 0.0005));
      }
    return frame;
  }

 private:
  double depth_m(const Vec3d& from, const Vec3d& ray) const {
    if (bare_wall) return 2 / ray.z();
    double nearest = 1e3;
    for (int x = -3; x <= 3; ++x)
      for (int y = -3; y <= 3; ++y) {
        const Vec3d center(0.5 * x, 0.5 * y, 1.6 + 0.15 * ((x + 2 * y + 9) % 3));
        const Vec3d to = from - center;
        const double a = ray.squaredNorm(), b = ray.dot(to), c = to.squaredNorm() - 0.36 * 0.36;
        if (const double d = b * b - a * c; d > 0)
          nearest = std::min(nearest, (-b - std::sqrt(d)) / a);
      }
    return nearest < 1e3 ? nearest : 0;
  }

  io::RecordingInfo info_;
};

Gravity down_at(int frame) {
  return {pose_at(frame).linear().transpose() * Vec3d::UnitY(), GravitySource::imu, 1, "measured"};
}

Frame resolved(const SequenceGravity& gravity,
               const Balls& recording,
               int index,
               const io::PickedGravity& picked = {}) {
  Frame frame = recording.frame(index);
  gravity.resolve(frame, picked);
  return frame;
}

double off_deg(const Frame& frame) {
  if (!frame.gravity) return 180;
  const Vec3d down = down_at(frame.index).direction;
  return std::atan2(frame.gravity->direction.cross(down).norm(),
                    frame.gravity->direction.dot(down)) *
         180 / std::numbers::pi;
}

TEST(SequenceGravity, IsTransferredFromTheNearestKnownFrameByOdometry) {
  const auto recording = std::make_shared<Balls>();
  recording->reported[0] = down_at(0);
  recording->reported[6] = down_at(6);
  const SequenceGravity gravity(recording, {});
  const Frame second = resolved(gravity, *recording, 2), last = resolved(gravity, *recording, 7);
  ASSERT_TRUE(second.gravity && last.gravity);
  EXPECT_EQ(second.gravity->source, GravitySource::carried);
  EXPECT_EQ(second.gravity->note,
            "carried from frame 0, where it was measured, by odometry over 2 frames");
  EXPECT_EQ(last.gravity->note,
            "carried from frame 6, where it was measured, by odometry over 1 frame");
  EXPECT_LT(off_deg(second), 0.5);
  EXPECT_LT(off_deg(last), 0.5);
  EXPECT_EQ(resolved(gravity, *recording, 6).gravity->source, GravitySource::imu);
}

TEST(SequenceGravity, IsTheSameInAnyOrderAndForAnyNumberOfThreads) {
  const auto recording = std::make_shared<Balls>();
  recording->reported[3] = down_at(3);
  const SequenceGravity one(recording, {}), other(recording, {});
  std::vector<Vec3d> forwards(kBallFrames), side_by_side(kBallFrames);
  for (int i = 0; i < kBallFrames; ++i)
    forwards[i] = resolved(one, *recording, i).gravity.value().direction;
  work_through(kBallFrames, 4, [&](int i) {
    side_by_side[kBallFrames - 1 - i] =
        resolved(other, *recording, kBallFrames - 1 - i).gravity.value().direction;
  });
  EXPECT_EQ(forwards, side_by_side);
}

TEST(SequenceGravity, UsesThePosesOfTheRecordingIfAvailable) {
  const auto recording = std::make_shared<Balls>();
  recording->reported[0] = down_at(0);
  recording->poses = true;
  recording->empty = {3};
  const Frame last = resolved(SequenceGravity(recording, {}), *recording, 7);
  EXPECT_LT(off_deg(last), 1e-6);
  EXPECT_EQ(last.gravity->note,
            "carried from frame 0, where it was measured, by the recording's poses over 7 frames");
}

TEST(SequenceGravity, EndsWhereMotionIsUnknown) {
  const auto recording = std::make_shared<Balls>();
  recording->reported[0] = down_at(0);
  recording->empty = {3};
  const SequenceGravity gravity(recording, {});
  EXPECT_TRUE(resolved(gravity, *recording, 2).gravity);
  EXPECT_FALSE(resolved(gravity, *recording, 4).gravity);
  // Depth of a bare wall does not change when the camera rolls.
  const auto wall = std::make_shared<Balls>();
  wall->reported[0] = down_at(0);
  wall->bare_wall = true;
  EXPECT_FALSE(resolved(SequenceGravity(wall, {}), *wall, 1).gravity);
}

TEST(SequenceGravity, OfAPickIsUsedForOtherFrames) {
  const auto recording = std::make_shared<Balls>();
  const SequenceGravity gravity(recording, {});
  EXPECT_FALSE(resolved(gravity, *recording, 4).gravity);
  io::PickedGravity picked;
  picked.frames[1].frame = 1;
  picked.frames[1].direction = down_at(1).direction;
  picked.frames[1].note = "picked: a floor";
  EXPECT_EQ(resolved(gravity, *recording, 1, picked).gravity->source, GravitySource::picked);
  const Frame carried = resolved(gravity, *recording, 4, picked);
  EXPECT_LT(off_deg(carried), 0.5);
  EXPECT_EQ(carried.gravity->source, GravitySource::carried);
  EXPECT_EQ(carried.gravity->confidence, 1);
}

}  // namespace
}  // namespace planescope::world
