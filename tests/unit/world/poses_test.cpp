#include <gtest/gtest.h>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/world/poses/pose_graph.hpp"
#include "core/world/poses/trajectory.hpp"
#include "core/world/poses/upright.hpp"
#include "support/temp_dir.hpp"

namespace planescope::world {
namespace {

std::filesystem::path written(const std::string& name, const std::string& text) {
  const std::filesystem::path path = temp_dir() / name;
  write_file_text(path, text);
  return path;
}

Mat3d turn(double angle, const Vec3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

Pose pose(double x, double y, double z, double angle, const Vec3d& axis) {
  Pose pose = Pose::Identity();
  pose.linear() = turn(angle, axis);
  pose.translation() = Vec3d(x, y, z);
  return pose;
}

std::string why_refused(const std::string& name, const std::string& text) {
  try {
    read_trajectory(written(name, text));
  } catch (const Error& error) {
    return error.what();
  }
  return "it was read";
}

TEST(Trajectory, IsWrittenAndReadWithFramesSegmentsAndQuality) {
  Trajectory trajectory{"test", {}};
  trajectory.poses.emplace_back().frame = 3;
  CameraPose& second = trajectory.poses.emplace_back();
  second.frame = 5;
  second.timestamp_s = 0.5;
  second.T_world_camera = pose(0.1, -2, 3e-7, 2.5, {1, 2, -3});
  second.segment = 1;
  second.fitness = 0.75;
  second.rms_m = 0.0125;
  for (CameraPose& pose : trajectory.poses) settle(pose);
  const Trajectory read = read_trajectory(written("a.tum", tum_text(trajectory)));
  ASSERT_EQ(read.poses.size(), 2u);
  EXPECT_EQ(read.poses[1].frame, 5);
  EXPECT_EQ(read.poses[1].segment, 1);
  EXPECT_EQ(read.poses[1].fitness, 0.75);
  EXPECT_EQ(read.poses[1].rms_m, 0.0125);
  EXPECT_EQ(read.poses[1].timestamp_s, 0.5);
  EXPECT_EQ(read.poses[1].T_world_camera.translation(),
            trajectory.poses[1].T_world_camera.translation());
  EXPECT_EQ(read.poses[1].T_world_camera.matrix(), trajectory.poses[1].T_world_camera.matrix());
}

TEST(Trajectory, OfOtherToolsIsToldByContent) {
  const std::string kitti = "1 0 0 5 0 1 0 6 0 0 1 7\n0 -1 0 1 1 0 0 2 0 0 1 3\n";
  EXPECT_EQ(read_trajectory(written("k.txt", kitti)).poses[1].T_world_camera.translation(),
            Vec3d(1, 2, 3));
  const std::string log = "0 0 1\n1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n";
  EXPECT_EQ(read_trajectory(written("a.log", log)).poses.at(0).T_world_camera.translation(),
            Vec3d(5, 6, 7));
  // Column by column, and the camera's view of the world.
  const std::string json =
      R"({"class_name": "PinholeCameraTrajectory", "parameters": [
          {"extrinsic": [1,0,0,0, 0,1,0,0, 0,0,1,0, -5,-6,-7,1]}]})";
  EXPECT_TRUE(read_trajectory(written("a.json", json))
                  .poses.at(0)
                  .T_world_camera.translation()
                  .isApprox(Vec3d(5, 6, 7)));
}

TEST(Trajectory, ThatIsNoneIsRefusedWithItsLine) {
  EXPECT_NE(why_refused("b.tum", "0 0 0 0 0 0 0 1\n1 2 3\n").find("line 2: expected the eight"),
            std::string::npos);
  EXPECT_NE(why_refused("c.tum", "0 0 0 0 0 0 0 2\n").find("length 1"), std::string::npos);
  EXPECT_NE(why_refused("d.tum", "# nothing\n").find("holds no pose"), std::string::npos);
  EXPECT_NE(why_refused("e.txt", "1 0 0 5 0 1 0 6 0 0 2 7\n").find("no rotation"),
            std::string::npos);
  EXPECT_NE(why_refused("f.log", "0 0 1\n1 0 0 5\n").find("before its four rows"),
            std::string::npos);
  EXPECT_NE(why_refused("g.txt", "hello\n").find("expected TUM"), std::string::npos);
  EXPECT_NE(why_refused("h.json", "{\"parameters\": [{}]}").find("'extrinsic' of entry 0"),
            std::string::npos);
}

TEST(Trajectory, GivesFramesThePosesOfTheirTime) {
  Trajectory trajectory{"test", {}};
  for (const double t : {0.2, 0.0, 0.1}) {  // out of order
    CameraPose& next = trajectory.poses.emplace_back();
    next.timestamp_s = t;
    next.T_world_camera.translation().x() = t;
  }
  const auto found = poses_of_frames(trajectory, {{0, 0.004}, {1, 0.11}, {2, 0.6}});
  ASSERT_TRUE(found[0] && found[1]);
  EXPECT_EQ(found[0]->T_world_camera.translation().x(), 0);
  EXPECT_EQ(found[1]->T_world_camera.translation().x(), 0.1);
  EXPECT_EQ(found[1]->frame, 1);
  EXPECT_FALSE(found[2]);
  EXPECT_THROW(poses_of_frames(trajectory, {{0, 60}}), Error);
}

TEST(SharedGravity, LeavesOutStraysAndTellsTheSpread) {
  std::vector<GravitySample> samples;
  for (int i = 0; i < 20; ++i) {
    GravitySample sample;
    sample.T_world_camera = pose(0, 0, 0, 0.1 * i, {1, -1, 2});
    Vec3d down = turn(0.01 * (i % 2 == 0 ? 1 : -1), {1, 0, 0}) * -Vec3d::UnitZ();
    if (i == 7) down = Vec3d::UnitX();
    sample.gravity.direction = sample.T_world_camera.linear().transpose() * down;
    sample.gravity.source = GravitySource::imu;
    samples.push_back(sample);
  }
  const SharedGravity shared = shared_gravity(samples);
  EXPECT_EQ(shared.strays, 1);
  EXPECT_EQ(shared.source, GravitySource::imu);
  EXPECT_NEAR(shared.spread_deg, 0.573, 0.05);
  EXPECT_LT((shared.direction + Vec3d::UnitZ()).norm(), 0.002);
}

TEST(SharedGravity, LeavesAWorldThatStandsUprightAsItIs) {
  const Pose before = pose(1, 2, 3, -1.57, {1, 0, 0});
  Trajectory trajectory{"test", std::vector<CameraPose>(1)};
  trajectory.poses[0].T_world_camera = before;
  GravitySample sample{before, {}};
  sample.gravity.source = GravitySource::imu;
  sample.gravity.direction =
      before.linear().transpose() * (turn(0.02, {0, 1, 0}) * -Vec3d::UnitZ());
  const int segment = 0;
  turn_upright(trajectory, std::span(&sample, 1), std::span(&segment, 1));
  EXPECT_EQ(trajectory.poses[0].T_world_camera.matrix(), before.matrix());
  // One that lies on its side is turned.
  sample.gravity.direction = before.linear().transpose() * Vec3d::UnitX();
  turn_upright(trajectory, std::span(&sample, 1), std::span(&segment, 1));
  EXPECT_TRUE((trajectory.poses[0].T_world_camera.linear() * sample.gravity.direction)
                  .isApprox(-Vec3d::UnitZ(), 1e-9));
}

TEST(PoseGraph, SharesOutWhatDoesNotAgreeAndLeavesAWrongLoopOut) {
  // Round a square, each side measured 1 cm too long; the loop says where the start is.
  const Pose side = pose(1, 0, 0, 1.5707963267948966, {0, 0, 1});
  Pose measured = side;
  measured.translation().x() = 1.01;
  std::vector<Pose> poses(5, Pose::Identity());
  std::vector<PoseEdge> edges;
  for (int i = 0; i < 4; ++i) {
    poses[i + 1] = poses[i] * measured;
    edges.push_back({i, i + 1, measured, 1e4 * Mat6d::Identity()});
  }
  edges.push_back({4, 0, pose(0.05, 0, 0, 0, {0, 0, 1}), 1e6 * Mat6d::Identity(), true});
  std::vector<Pose> found = poses;
  optimise_poses(found, edges);
  EXPECT_TRUE(found[0].isApprox(Pose::Identity(), 1e-6));
  EXPECT_NEAR((found[4].inverse() * found[0]).translation().x(), 0.05, 0.003);
  edges.back().T_from_to = pose(40, 0, 0, 0, {0, 0, 1});
  found = poses;
  optimise_poses(found, edges);
  EXPECT_LT((found[4].translation() - poses[4].translation()).norm(), 0.5);
}

}  // namespace
}  // namespace planescope::world
