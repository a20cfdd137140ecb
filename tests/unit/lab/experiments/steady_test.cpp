// Tests of the stability experiment: plane agreement, pixel warping and changes.

#include "core/lab/experiments/steady.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace planescope::lab {
namespace {

using PixelIds = std::vector<std::int32_t>;

/// Makes ids from runs of pixels, given as plane and number of pixels.
PixelIds ids_of(const std::vector<std::pair<int, int>>& plane_and_pixels) {
  PixelIds ids;
  for (const auto& [plane, pixels] : plane_and_pixels)
    ids.insert(ids.end(), static_cast<std::size_t>(pixels), plane);
  return ids;
}

TEST(Steadiness, TheSamePlanesWithOtherNumbersAgreeFully) {
  const Agreement a = compare_planes_by_pixel(ids_of({{1, 60}, {0, 10}, {2, 30}}),
                                              ids_of({{7, 60}, {0, 10}, {3, 30}}));
  EXPECT_DOUBLE_EQ(a.all.iou_sum, 2);
  EXPECT_EQ(a.all.planes, 2);
  EXPECT_EQ(a.all.planes - a.all.partners, 0);
  EXPECT_EQ(a.changed, 0);
  EXPECT_EQ(a.partner, (std::vector<int>{7, 3}));
}

TEST(Steadiness, APlaneCutInTwoEqualHalvesIsLost) {
  const Agreement a =
      compare_planes_by_pixel(ids_of({{1, 100}, {2, 40}}), ids_of({{1, 50}, {2, 50}, {3, 40}}));
  EXPECT_EQ(a.all.planes, 2);
  EXPECT_EQ(a.all.planes - a.all.partners, 1) << "an IoU of exactly one half makes no partner";
  EXPECT_EQ(a.second_planes, 3);
  EXPECT_DOUBLE_EQ(a.all.iou_sum, 1);
  EXPECT_EQ(a.partner, (std::vector<int>{0, 3}));
}

TEST(Steadiness, APlaneWithoutAnAlmostEqualOneHasChangedEvenWithAPartner) {
  const Agreement a = compare_planes_by_pixel(ids_of({{1, 200}, {0, 2}, {2, 50}}),
                                              ids_of({{1, 202}, {2, 49}, {0, 1}}));
  EXPECT_EQ(a.all.partners, 2);
  EXPECT_EQ(a.changed, 1) << "200 of 202 are the same, 49 of 50 are not";
  EXPECT_DOUBLE_EQ(a.all.iou_sum, 200 / 202.0 + 49 / 50.0);
}

TEST(Steadiness, OnlyComparedPixelsCountAndPlanesWithoutAnyAreIgnored) {
  const Agreement a = compare_planes_by_pixel(ids_of({{1, 50}, {-1, 80}, {3, 20}}),
                                              ids_of({{1, 70}, {2, 60}, {3, 20}}));
  EXPECT_EQ(a.all.planes, 2) << "plane 2 of the first image has no pixel left";
  EXPECT_EQ(a.second_planes, 2) << "so has plane 2 of the second";
  EXPECT_DOUBLE_EQ(a.all.iou_sum, 2);
}

TEST(Steadiness, BigPlanesHaveAtLeast3000ComparedPixels) {
  const Agreement a =
      compare_planes_by_pixel(ids_of({{1, 3000}, {2, 2999}, {3, 4000}}), PixelIds(9999, 0));
  EXPECT_EQ(a.all.big, 2);
  EXPECT_EQ(a.all.big_lost, 2);
  EXPECT_EQ(a.all.planes - a.all.partners, 3);
  EXPECT_DOUBLE_EQ(a.all.iou_sum, 0);
}

TEST(Steadiness, UndecidedPlanesDoNotCountAsDecided) {
  const std::vector<std::uint8_t> undecided = {1, 0};
  const Agreement a = compare_planes_by_pixel(ids_of({{1, 4000}, {2, 5000}, {3, 10}}),
                                              ids_of({{0, 4000}, {2, 5000}, {3, 10}}), undecided);
  EXPECT_EQ(a.all.planes, 3);
  EXPECT_EQ(a.all.big_lost, 1);
  EXPECT_EQ(a.decided.planes, 2);
  EXPECT_EQ(a.decided.planes - a.decided.partners, 0);
  EXPECT_EQ(a.decided.big, 1);
  EXPECT_EQ(a.decided.big_lost, 0);
  EXPECT_DOUBLE_EQ(a.decided.iou_sum, 2);
}

constexpr int kImageWidth = 40, kImageHeight = 30;
constexpr double kImageFocal = 40;

DepthMeters wall_at(double depth_m) {
  DepthMeters depth;
  depth.intrinsics = {kImageWidth, kImageHeight,      kImageFocal,
                      kImageFocal, kImageWidth / 2.0, kImageHeight / 2.0};
  depth.depth_m.assign(kImageWidth * kImageHeight, depth_m);
  return depth;
}

/// Plane 1 is left of column 20, plane 2 right.
PixelIds two_halves() {
  PixelIds ids;
  for (int i = 0; i < kImageWidth * kImageHeight; ++i) ids.push_back(i % kImageWidth < 20 ? 1 : 2);
  return ids;
}

TEST(Steadiness, LabelsMoveWithTheCamera) {
  Pose T_second_first = Pose::Identity();  // the camera moves 0.1 m to the right: 4 px at 1 m
  T_second_first.translation().x() = -0.1;
  const PixelIds warped = warp_planes(two_halves(), wall_at(1), wall_at(1), T_second_first);
  for (int v = 0; v < kImageHeight; ++v)
    for (int u = 0; u < kImageWidth; ++u)
      ASSERT_EQ(warped[v * kImageWidth + u], u >= kImageWidth - 4 ? -1
                                             : u < 16             ? 1
                                                                  : 2)
          << u << ", " << v;
}

TEST(Steadiness, APixelIsComparedIfBothDepthsAgreeWithinThreePercent) {
  Pose forward = Pose::Identity();
  forward.translation().z() = -0.5;  // the wall moves from 2 m to 1.5 m
  const auto seen = [&](double second_m) {
    const PixelIds warped = warp_planes(two_halves(), wall_at(2), wall_at(second_m), forward);
    return warped[15 * kImageWidth + 20];
  };
  EXPECT_EQ(seen(1.5), 2);
  EXPECT_EQ(seen(1.54), 2);
  EXPECT_EQ(seen(1.55), -1);
  EXPECT_EQ(seen(2.0), -1);
  EXPECT_EQ(seen(0), -1) << "not measured";
}

TEST(Steadiness, PixelsOutsideTheSecondViewAreNotCompared) {
  Pose behind = Pose::Identity();
  behind.translation().z() = -1.5;
  Pose away = Pose::Identity();
  away.linear() = Eigen::AngleAxisd(2, Vec3d::UnitY()).toRotationMatrix();
  for (const Pose& T_second_first : {behind, away})
    for (const std::int32_t id : warp_planes(two_halves(), wall_at(1), wall_at(1), T_second_first))
      ASSERT_EQ(id, -1);
}

TEST(Steadiness, WithoutPosesPixelsStayInPlace) {
  DepthMeters second = wall_at(1.02);
  second.depth_m[0] = 1.04;
  second.depth_m[1] = 0;
  PixelIds expected = two_halves();
  expected[0] = expected[1] = -1;
  EXPECT_EQ(planes_in_place(two_halves(), wall_at(1), second), expected);
}

TEST(Steadiness, DepthsBeyondTheRangeAndInvalidOnesAreNotCompared) {
  Frame frame;
  frame.depth = Image16(4, 1);
  frame.depth.data = {0, 1000, 4001, 65535};
  frame.depth_unit_m = 0.001;
  EXPECT_EQ(depth_meters(frame, 4).depth_m, (std::vector<double>{0, 1, 0, 0}));
  frame.depth_unit_m = 0.00001;
  EXPECT_EQ(depth_meters(frame, 4).depth_m[3], 0) << "whatever its distance would be";
}

// ---- Measurements ----

/// A recording in which only one frame has a pose.
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

TEST(MeasureSteady, ARecordingsPosesAreReadByFrame) {
  PosesAlone recording;
  EXPECT_TRUE(own_poses(recording).empty());
  recording.own_pose_of = 1;
  const FramePoses poses = own_poses(recording);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_FALSE(poses[0]);
  EXPECT_TRUE(poses[1]);
}

TEST(MeasureSteady, ATurnHasItsAngleForAnyAxis) {
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

}  // namespace
}  // namespace planescope::lab
