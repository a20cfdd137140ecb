#include "core/lab/experiments/measure_steady.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/model/error.hpp"

namespace planescope::lab {
namespace {

/// Frames of which only one has a pose.
class PosesAlone : public io::Recording {
 public:
  const io::RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return 2; }
  Frame frame(int) const override { return {}; }
  std::optional<Pose> T_world_camera(int i) const override {
    return i == own_pose_of ? std::optional<Pose>(Pose::Identity()) : std::nullopt;
  }
  std::string frame_hash(int) const override { return {}; }

  int own_pose_of = -1;

 private:
  io::RecordingInfo info_;
};

TEST(MeasureSteady, ARecordingsOwnPosesAreByFrame) {
  PosesAlone recording;
  EXPECT_TRUE(own_poses(recording).empty());
  recording.own_pose_of = 1;
  const FramePoses poses = own_poses(recording);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_FALSE(poses[0]);
  EXPECT_TRUE(poses[1]);
}

TEST(MeasureSteady, ATurnIsByItsAngleWhateverTheAxis) {
  const Vec3d down = Vec3d(0.1, 0.9, 0.3).normalized();
  for (const double angle_deg : {1e-6, 1e-3, 0.1})
    for (const double around_deg : {0.0, 77.0, 200.0}) {
      const Vec3d after = turned(down, angle_deg, around_deg);
      EXPECT_NEAR(after.norm(), 1, 1e-15);
      const double sine = down.cross(after).norm();
      EXPECT_NEAR(std::asin(sine) * 180 / std::numbers::pi / angle_deg, 1, 1e-6);
    }
  EXPECT_GT((turned(down, 0.1, 0) - turned(down, 0.1, 180)).norm(), 1e-3);
}

TEST(MeasureSteady, IntrinsicsAreRoundedToSixSignificantDigits) {
  Intrinsics camera;
  camera.fx = 390.43144226;
  camera.fy = 1390.4366;
  camera.cx = 99.99999999;
  camera.cy = 0;
  const Intrinsics rounded = rounded_to_six_digits(camera);
  EXPECT_DOUBLE_EQ(rounded.fx, 390.431);
  EXPECT_DOUBLE_EQ(rounded.fy, 1390.44);
  EXPECT_DOUBLE_EQ(rounded.cx, 100);
  EXPECT_EQ(rounded.cy, 0);
}

TEST(MeasureSteady, DitherMovesFivePercentOfTheValidPixelsByOneCount) {
  Image16 depth(500, 400, 1, 1000);
  for (int u = 0; u < 500; ++u) {
    depth.at(u, 0) = 0;
    depth.at(u, 1) = 65535;
  }
  Image16 dithered = depth;
  dither(dithered, 3);
  int up = 0, down = 0;
  for (std::size_t i = 0; i < depth.data.size(); ++i) {
    const int by = dithered.data[i] - depth.data[i];
    up += by == 1;
    down += by == -1;
    ASSERT_LE(std::abs(by), 1);
    ASSERT_TRUE(by == 0 || i >= 1000) << "not a measurement";
  }
  EXPECT_NEAR(up, 0.025 * 199000, 300);
  EXPECT_NEAR(down, 0.025 * 199000, 300);
  Image16 again = depth;
  dither(again, 3);
  EXPECT_EQ(again.data, dithered.data);
  dither(again, 4);
  EXPECT_NE(again.data, dithered.data);
}

/// A pair of frames with this many big planes lost, of ten.
SteadyPair pair_with(int big_lost, double iou_sum) {
  SteadyPair pair;
  pair.planes.all.planes = pair.planes.all.big = 10;
  pair.planes.all.partners = 10 - big_lost;
  pair.planes.all.iou_sum = iou_sum;
  pair.planes.all.big_lost = big_lost;
  pair.planes.second_planes = 10;
  return pair;
}

const SteadyFigure& figure(const std::string& name) {
  for (const SteadyFigure& figure : steady_figures())
    if (name == figure.name) return figure;
  throw Error("no figure " + name);
}

TEST(SteadyResults, AFigureIsTheMeanOverFramesWithItsStandardError) {
  SteadyRow row;
  row.part = SteadyPart::dither;
  row.frames = {{0, {pair_with(1, 8), pair_with(3, 6)}}, {8, {pair_with(4, 5)}}};
  const auto pq = steady_figure(figure("self_pq"), row);
  ASSERT_TRUE(pq);
  EXPECT_NEAR(pq->mean, 0.6, 1e-12) << "of .7 and .5: each frame counts the same";
  EXPECT_NEAR(pq->error, 0.1, 1e-12);
  const auto big = steady_figure(figure("big_lost_percent"), row);
  ASSERT_TRUE(big);
  EXPECT_NEAR(big->mean, 100 * 8 / 30.0, 1e-12) << "of all pairs together";
  EXPECT_GT(big->error, 0);
  EXPECT_FALSE(steady_figure(figure("report_errors"), row)) << "not of dither";
  row.frames.pop_back();
  EXPECT_TRUE(std::isnan(steady_figure(figure("self_pq"), row)->error)) << "one frame";
  row.frames.clear();
  EXPECT_FALSE(steady_figure(figure("self_pq"), row));
}

}  // namespace
}  // namespace planescope::lab
