// Tests of trajectories, frame-pose pairing, shared gravity and the pose graph.

#include "core/world/poses/poses.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/world/map_recording.hpp"
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

/// A recording with times only.
class TimesAlone : public io::Recording {
 public:
  explicit TimesAlone(std::vector<double> times) : times_(std::move(times)) {
    info_.path = "recording";
  }
  const io::RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(times_.size()); }
  Frame frame(int) const override { return {}; }
  double timestamp_s(int i) const override { return times_[static_cast<std::size_t>(i)]; }
  std::string frame_hash(int) const override { return {}; }

 protected:
  std::vector<double> times_;
  io::RecordingInfo info_;
};

/// Nothing is measured in the first of two frames, and the second one is damaged.
class Damaged : public TimesAlone {
 public:
  Damaged() : TimesAlone({0, 0.1}) {
    info_.width = 8;
    info_.height = 6;
    info_.intrinsics = {8, 6, 8, 8, 4, 3, Distortion::none, {}};
  }
  Frame frame(int i) const override {
    if (i == 1) throw Error("a.mcap: was cut while it was read");
    Frame frame;
    frame.depth = Image16(8, 6);
    frame.depth_unit_m = 0.001;
    frame.intrinsics = info_.intrinsics;
    return frame;
  }
};

/// A trajectory in which pose i is at x = i.
Trajectory at_times(const std::vector<double>& times) {
  Trajectory trajectory{"poses.tum", {}};
  for (const double t : times) {
    const auto x = static_cast<double>(trajectory.poses.size());
    trajectory.poses.push_back(
        {.timestamp_s = t, .T_world_camera = pose(x, 0, 0, 0, Vec3d::UnitX())});
  }
  return trajectory;
}

/// Index of the pose of each frame; -1: none.
std::vector<int> paired(const Trajectory& trajectory,
                        const io::Recording& recording,
                        const std::vector<int>& frames) {
  std::vector<int> numbers;
  for (const auto& pose : pair_poses(trajectory, recording, frames).poses)
    numbers.push_back(pose ? static_cast<int>(pose->T_world_camera.translation().x()) : -1);
  return numbers;
}

std::string why_unpaired(const Trajectory& trajectory,
                         const io::Recording& recording,
                         const std::vector<int>& frames) {
  try {
    pair_poses(trajectory, recording, frames);
  } catch (const Error& error) {
    return error.what();
  }
  return "they were paired";
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

TEST(Trajectory, OfOtherToolsIsRecognizedByContent) {
  const std::string kitti = "1 0 0 5 0 1 0 6 0 0 1 7\n0 -1 0 1 1 0 0 2 0 0 1 3\n";
  EXPECT_EQ(read_trajectory(written("k.txt", kitti)).poses[1].T_world_camera.translation(),
            Vec3d(1, 2, 3));
  const std::string log = "0 0 1\n1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n";
  EXPECT_EQ(read_trajectory(written("a.log", log)).poses.at(0).T_world_camera.translation(),
            Vec3d(5, 6, 7));
  // Column-major, as world-to-camera transforms.
  const std::string json =
      R"({"class_name": "PinholeCameraTrajectory", "parameters": [
          {"extrinsic": [1,0,0,0, 0,1,0,0, 0,0,1,0, -5,-6,-7,1]}]})";
  EXPECT_TRUE(read_trajectory(written("a.json", json))
                  .poses.at(0)
                  .T_world_camera.translation()
                  .isApprox(Vec3d(5, 6, 7)));
}

TEST(Trajectory, MayContainAByteOrderMarkCarriageReturnsTabsAndComments) {
  const std::string tum =
      "\xEF\xBB\xBF# by a tool\r\n-1.5\t1 2 3  0 0 0 1 # here\r\n\r\n-0.5 4 5 6 0 0 0 1\r\n";
  const Trajectory read = read_trajectory(written("w.tum", tum));
  ASSERT_EQ(read.poses.size(), 2u);
  EXPECT_EQ(read.poses[0].timestamp_s, -1.5);
  EXPECT_EQ(read.poses[1].T_world_camera.translation(), Vec3d(4, 5, 6));
  const std::string json =
      "\xEF\xBB\xBF{\"parameters\": [{\"extrinsic\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]}\r\n";
  EXPECT_EQ(read_trajectory(written("w.json", json)).poses.size(), 1u);
  const std::string kitti =
      "\xEF\xBB\xBF"
      "1 0 0 5 0 1 0 6 0 0 1 7\r\n";
  EXPECT_EQ(read_trajectory(written("w.txt", kitti)).poses.size(), 1u);
}

TEST(Trajectory, ThatIsDamagedIsRejectedWithItsLine) {
  const auto expect = [](const char* name, const std::string& text, const std::string& reported) {
    const std::string why = why_refused(name, text);
    EXPECT_NE(why.find(std::string(name) + reported), std::string::npos) << why;
  };
  const std::string fine = "0 0 0 0 0 0 0 1\n", kitti = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  expect("b.tum", fine + "1 2 3\n", ", line 2: 3 words; expected the eight numbers");
  expect("b.tum", fine + "1 2 3 0 0 0 0 step\n", ", line 2: 'step' is not a number");
  expect("b.tum", "nan 2 3 0 0 0 0 1\n", ", line 1: 'nan' is not a number");
  expect("b.tum", fine + "# a\n\n1 2 inf 0 0 0 0 1\n", ", line 4: 'inf' is not a number");
  expect("b.tum", "time x y z qx qy qz qw\n" + fine, ", line 1: 'time' is not a number");
  expect("c.tum", "0 0 0 0 0 0 0 2\n", ", line 1: the quaternion qx qy qz qw has length 2; ");
  expect("c.tum", "0 0 0 0 0 0 0 0\n", ", line 1: the quaternion qx qy qz qw has length 0; ");
  expect("d.tum", "# nothing\n", ": contains no poses");
  expect("e.txt", "1 0 0 5 0 1 0 6 0 0 2 7\n", ", line 1: the matrix is not a rigid transform");
  expect("e.txt", kitti + "1 0 0 NaN 0 1 0 0 0 0 1 0\n", ", line 2: 'NaN' is not a number");
  expect("f.log", "0 0 1\n1 0 0 5\n", ", line 1: the pose has fewer than four rows");
  expect("f.log", "0 0 1\n1 0 0 5\n0 1 0 inf\n0 0 1 0\n0 0 0 1\n", ", line 3: 'inf' is not a");
  expect("f.log", "0 0 1\n1 0 0 5\n0 1 0 6\n0 0 1 0\n0 0 0 2\n", ", line 1: the matrix is not");
  expect("g.txt", "hello\n", ", line 1: 1 word; expected TUM");
  expect("h.json", "{\"parameters\": [{}]}", ": parameters[0]");
  expect("h.json", "{\"parameters\": [{\"extrinsic\": [1,0,0,0,0,1,0,0,0,0,1,0,\"a\",0,0,1]}]}",
         ": parameters[0]");
  // Row-major.
  expect("h.json", "{\"parameters\": [{\"extrinsic\": [1,0,0,5,0,1,0,0,0,0,1,0,0,0,0,1]}]}",
         ": parameters[0]");
  expect("i.tum", "# frame 0 segment 900000000\n" + fine, ", line 2: segment 900000000; expected");
}

TEST(Trajectory, ThatJumpsFartherThanACameraIsRejectedWithItsLine) {
  const std::string fine = "0 0 0 0 0 0 0 1\n";
  const auto expect = [](const char* name, const std::string& text, const std::string& reported) {
    const std::string why = why_refused(name, text);
    EXPECT_NE(why.find(std::string(name) + reported), std::string::npos) << why;
  };
  expect("l.tum", fine + "1 1e9 0 0 0 0 0 1\n",
         ", line 2: the pose is 1e+09 m from the first pose");
  expect("l.tum", fine + "1 2e5 0 0 0 0 0 1\n", ", line 2: the pose is 200000 m from the first");
  expect("l.tum", "1 1e9 0 0 0 0 0 1\n" + fine, ", line 1: the pose is 1e+09 m from the world's");
  expect("l.tum", fine + "1 1e300 1e300 0 0 0 0 1\n", ", line 2: the pose is 1.41421e+300 m from");
  expect("l.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 2e5 0 0 1 0\n", ", line 2: the pose is");
  expect("l.json",
         "{\"parameters\": [{\"extrinsic\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]},"
         "{\"extrinsic\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,2e5,1]}]}",
         ", entry 1: the pose is 200000 m from the first");
  // Far from the origin, but close together.
  EXPECT_EQ(read_trajectory(written("far.tum", "0 4e6 5e6 0 0 0 0 1\n1 4e6 5e6 1 0 0 0 1\n"))
                .poses.size(),
            2u);
}

TEST(Trajectory, WithTwoPosesAtOneTimeIsRejectedUnlessTheyAreEqual) {
  const std::string first = "2 0 0 0 0 0 0 1\n", second = "1 5 0 0 0 0 0 1\n";
  EXPECT_EQ(read_trajectory(written("s.tum", first + second + first)).poses.size(), 3u);
  EXPECT_NE(why_refused("s.tum", first + second + "2 0 0 1 0 0 0 1\n")
                .find("lines 1 and 3: two different poses for the time 2 s"),
            std::string::npos);
  // With frame numbers, times may be unknown.
  const std::string numbered = "# frame 0\n0 0 0 0 0 0 0 1\n# frame 1\n0 1 0 0 0 0 0 1\n";
  EXPECT_EQ(read_trajectory(written("n.tum", numbered)).poses.size(), 2u);
  EXPECT_NE(why_refused("n.tum", numbered + "# frame 1\n0 2 0 0 0 0 0 1\n")
                .find("lines 4 and 6: two different poses for frame 1"),
            std::string::npos);
}

TEST(PairPoses, FramesGetThePoseOfTheirTimeInAnyOrder) {
  const TimesAlone recording({0.004, 0.11, 0.6});
  const PairedPoses found = pair_poses(at_times({0.2, 0.0, 0.1}), recording, std::vector{0, 1, 2});
  ASSERT_TRUE(found.poses[0] && found.poses[1]);
  EXPECT_EQ(found.poses[0]->T_world_camera.translation().x(), 1);
  EXPECT_EQ(found.poses[1]->T_world_camera.translation().x(), 2);
  EXPECT_EQ(found.poses[1]->frame, 1);
  EXPECT_EQ(found.poses[1]->timestamp_s, 0.11);
  EXPECT_FALSE(found.poses[2]) << "no pose is near";
  EXPECT_EQ(found.notice, "");
  EXPECT_NE(why_unpaired(at_times({60, 61}), recording, {0, 1, 2})
                .find("no pose is close in time to a frame: poses are from 60 s to 61 s, frames "
                      "from 0.004 s"),
            std::string::npos);
}

TEST(PairPoses, NumbersDecideUnlessTimesShowThatFramesWereAddedOrRemoved) {
  Trajectory numbered = at_times({5, 6, 7, 8});
  for (CameraPose& pose : numbered.poses)
    pose.frame = static_cast<int>(pose.T_world_camera.translation().x());
  EXPECT_EQ(paired(numbered, TimesAlone({5, 6.2, 7, 8}), {0, 1, 2, 3}), (std::vector{0, 1, 2, 3}));
  EXPECT_EQ(paired(numbered, TimesAlone({0, 0, 0, 0}), {1, 2}), (std::vector{1, 2}));
  const TimesAlone removed({5, 7, 8});
  EXPECT_EQ(paired(numbered, removed, {0, 1, 2}), (std::vector{0, 2, 3}));
  EXPECT_EQ(pair_poses(numbered, removed, std::vector{0}).notice,
            "frame 1 has a different time in poses.tum; poses are paired by time, not by number");
  // Without times, missing frames cannot be identified.
  const std::string why = why_unpaired(numbered, TimesAlone({0, 0, 0}), {0, 1, 2});
  EXPECT_NE(why.find("contains a pose for frame 3, but recording has 3 frames and no times"),
            std::string::npos)
      << why;
  numbered.poses.pop_back();
  for (CameraPose& pose : numbered.poses) pose.timestamp_s = 0;
  EXPECT_EQ(paired(numbered, removed, {0, 1, 2}), (std::vector{0, 1, 2}));
}

TEST(PairPoses, APoseNearestToTwoFramesIsRejected) {
  const TimesAlone recording({0, 0.1, 0.2, 0.3});
  const std::string why = why_unpaired(at_times({0, 1000, 2000, 3000}), recording, {0, 1, 2, 3});
  EXPECT_NE(why.find("poses.tum: the pose at 0 s is the nearest one to both frame 0 and frame 1"),
            std::string::npos)
      << why;
  EXPECT_NE(why.find("in seconds"), std::string::npos) << why;
}

TEST(PairPoses, FramesWithoutTimesArePairedInOrderForAnySelection) {
  const TimesAlone recording({0, 0, 0});
  const Trajectory three = at_times({1305.3, 1305.2, 1305.1});
  EXPECT_EQ(paired(three, recording, {0, 1, 2}), (std::vector{0, 1, 2}));
  EXPECT_EQ(paired(three, recording, {2}), (std::vector{2}));
  const PairedPoses found = pair_poses(three, recording, std::vector{1});
  EXPECT_EQ(found.poses[0]->timestamp_s, 1305.2);
  EXPECT_EQ(found.notice, "frames have no times: pose i in poses.tum is used for frame i");
  EXPECT_EQ(why_unpaired(at_times({5, 6}), recording, {0, 1}),
            "poses.tum: 2 poses; expected 3, one for each frame in recording, whose frames have no "
            "times");
}

TEST(PairPoses, PosesWithoutTimesBelongToTheRecordingOrTheSelectedFrames) {
  const TimesAlone recording({0, 1, 2});
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(paired(at_times({none, none, none}), recording, {1, 2}), (std::vector{1, 2}));
  EXPECT_EQ(paired(at_times({none, none}), recording, {1, 2}), (std::vector{0, 1}));
  EXPECT_EQ(pair_poses(at_times({none, none}), recording, std::vector{1, 2}).poses[0]->timestamp_s,
            1);
  EXPECT_EQ(why_unpaired(at_times({none}), recording, {1, 2}),
            "poses.tum: 1 pose without times; expected 3, one for each frame in recording");
}

TEST(SharedGravity, IgnoresOutliersAndReportsTheSpread) {
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

TEST(SharedGravity, DoesNotRotateAnUprightWorld) {
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
  // A world on its side is rotated.
  sample.gravity.direction = before.linear().transpose() * Vec3d::UnitX();
  turn_upright(trajectory, std::span(&sample, 1), std::span(&segment, 1));
  EXPECT_TRUE((trajectory.poses[0].T_world_camera.linear() * sample.gravity.direction)
                  .isApprox(-Vec3d::UnitZ(), 1e-9));
}

TEST(Odometry, WithoutAPoseTheDamagedFrameIsNamed) {
  const Damaged recording;
  MapJob job;
  job.recording = &recording;
  job.frames = {0, 1};
  try {
    map_recording(job);
    FAIL() << "it was mapped";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "recording: no frame has a pose; frame 1: a.mcap: was cut while it was read");
  }
}

TEST(PoseGraph, DistributesErrorsAndRejectsAWrongLoop) {
  // Around a square, with each side measured 1 cm too long; a loop closure identifies the start.
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
