// Tracks, gravity and certainty over real recordings ($PLANESCOPE_DATA), compared with earlier
// results.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/io/recording.hpp"
#include "core/lab/experiments/measure_map.hpp"
#include "core/lab/experiments/measure_real.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/world/files/map_files.hpp"
#include "core/world/poses/poses.hpp"
#include "support/temp_dir.hpp"

namespace planescope::world {
namespace {

struct RealMap : testing::Test {
  std::filesystem::path data;

  void SetUp() override {
    const char* folder = std::getenv("PLANESCOPE_DATA");
    if (!folder) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
    data = folder;
  }
};
using RealGravity = RealMap;
using RealCertainty = RealMap;

// A slow pan through a lab, with poses by odometry.
TEST_F(RealMap, FloorAndWallOfAPanAreOneTrackEach) {
  io::RecordingOptions options;
  options.intrinsics = {383.8, 383.8, 321.7, 236.8};
  const auto recording = io::open_recording(data / "aims_slam_realsense_640x480", options);
  MapJob job;
  job.recording = recording.get();
  const auto chosen =
      planes::make_classifier(job.pipeline, std::filesystem::path(PLANESCOPE_SOURCE_DIR) /
                                                "assets" / "classifier.safetensors");
  job.classifier = chosen.classifier.get();
  job.threads = 2;
  for (int i = 0; i < recording->frame_count(); ++i) job.frames.push_back(i);
  const WorldMap map = map_recording(job);

  const auto planes = planes_of_map(map.tracker);
  ASSERT_GE(planes.size(), 2u);
  const Track &floor = *planes[0], &wall = *planes[1];
  EXPECT_EQ(floor.label, Label::h);
  EXPECT_EQ(floor.frames_seen, 40);
  EXPECT_EQ(floor.frames_missed, 0);
  EXPECT_EQ(wall.label, Label::v);
  EXPECT_GE(wall.frames_seen, 23);
  EXPECT_EQ(wall.frames_missed, 0);
  EXPECT_GE(map.stability.kept_share, 0.975);
  EXPECT_LE(map.stability.breaks, 2.5);
  // The slow stretch, frames 29 to 33.
  EXPECT_GE(map.stability.still_pairs, 8);
  EXPECT_LE(map.stability.normal_jitter_deg, 0.08);
  EXPECT_LE(map.stability.offset_jitter_m, 0.0005);
}

/// With poses from motion capture.
WorldMap map_of_tum(const std::filesystem::path& folder, int first) {
  const auto recording = io::open_recording(folder);
  MapJob job;
  job.recording = recording.get();
  job.pipeline.cloud.max_range_m = 4;
  job.trajectory = read_trajectory(folder / "poses.tum");
  job.threads = 2;
  for (int i = first; i < recording->frame_count(); ++i) job.frames.push_back(i);
  return map_recording(job);
}

// Turned by hand above a desk: monitors hide most of the surfaces behind them, and the map has
// both.
TEST_F(RealMap, OfADeskKeepsItsPlanes) {
  const WorldMap map = map_of_tum(data / "tum_fr1_rpy_kinect_640x480", 0);
  ASSERT_EQ(map.tracker.frames().size(), 300u);
  for (const FrameOfTracks& frame : map.tracker.frames()) {
    EXPECT_FALSE(frame.set_aside) << frame.frame;
    if (frame.compared_cells >= 200) {
      EXPECT_GE(frame.agreement, 0.5) << frame.frame;
    }
  }
  EXPECT_LE(map.stability.breaks, 10);
  EXPECT_LE(map.stability.swaps, 1);
  EXPECT_GE(map.stability.kept_share, 0.98);
  EXPECT_LE(map.stability.drift_m, 0.02);
}

// Around a cabinet whose box was measured with the cameras of the motion capture. The pose of frame
// 0 is wrong.
TEST_F(RealMap, OfACabinetHasTheFloorAndEachFaceOnce) {
  const auto folder = data / "tum_fr3_cabinet_xtion_640x480";
  const WorldMap map = map_of_tum(folder, 1);
  for (const FrameOfTracks& frame : map.tracker.frames()) EXPECT_FALSE(frame.set_aside);
  EXPECT_LE(map.stability.breaks, 2);
  EXPECT_GE(map.stability.kept_share, 0.99);

  const MapTexts texts = map_texts(map, "cabinet");
  write_file_text(temp_dir() / "map.json", texts.map_json);
  write_file_text(temp_dir() / "poses.tum", texts.poses_tum);
  write_file_text(temp_dir() / "tracks.json", texts.tracks_json);
  const lab::MapTruthScore score =
      lab::measure_map_truth(temp_dir(), lab::read_cuboids(folder / "truth" / "truth_objects.txt"));
  ASSERT_EQ(score.faces.size(), 6u);
  for (const lab::FaceScore& face : score.faces) {
    EXPECT_EQ(face.planes, 1) << face.name;
    EXPECT_LE(std::abs(face.offset_m), 0.02) << face.name;
    EXPECT_LE(face.angle_deg, 2) << face.name;
  }
  EXPECT_EQ(score.elsewhere, 0);
}

/// Percentage of angles between two planes that change by at most 2 sigma in this number of frames.
double percent_within(const io::Recording& recording,
                      const lab::Reading& reading,
                      int count,
                      int step) {
  const planes::PipelineOptions options;
  lab::CellTools tools;
  tools.gcn = planes::make_classifier(options, std::filesystem::path(PLANESCOPE_SOURCE_DIR) /
                                                   "assets" / "classifier.safetensors")
                  .classifier;
  tools.threads = 2;
  const std::vector<lab::CellKey> ours = {lab::with_ours({}, "refined", "gcn")};
  const std::vector<lab::RepeatScores> scores =
      lab::measure_repeat(recording, reading, ours, count, step, tools);
  double within = 0, all = 0;
  for (const lab::Neighbors& pair : scores[0].neighbors)
    for (const double change : pair.angle_jumps_sigmas) {
      within += std::abs(change) <= 2;
      ++all;
    }
  EXPECT_GE(all, 100);
  return 100 * within / all;
}

// For a D400 and a Kinect. Neighbors at 30 Hz share errors, so more than 95 % are within 2 sigma;
// every third frame shares fewer errors.
TEST_F(RealCertainty, CoversTheChangeOfAnglesBetweenPlanes) {
  lab::Reading reading;
  reading.recording.intrinsics = {383.8, 383.8, 321.7, 236.8};
  reading.gravity = {planes::GravityMode::fixed, Vec3d(0.168, 0.925, 0.341)};
  reading.max_range_m = 4;
  const auto pan = io::open_recording(data / "aims_slam_realsense_640x480", reading.recording);
  EXPECT_GE(percent_within(*pan, reading, 0, 1), 93);
  const auto desk = io::open_recording(data / "tum_fr1_rpy_kinect_640x480");
  lab::Reading of_desk;
  of_desk.max_range_m = 4;
  EXPECT_GE(percent_within(*desk, of_desk, 100, 1), 93);
  EXPECT_NEAR(percent_within(*desk, of_desk, 100, 3), 95, 2);
}

double off_deg(const Gravity& gravity, const CameraPose& pose) {
  const Vec3d down = pose.T_world_camera.linear().transpose() * -Vec3d::UnitZ();
  return std::atan2(gravity.direction.cross(down).norm(), gravity.direction.dot(down)) * 180 /
         std::numbers::pi;
}

// Turned fast by hand. The accelerometer deviates by about 4 degrees from the poses of motion
// capture, for any choice of samples; the rest is acceleration of the hand.
TEST_F(RealGravity, OfAKinectsAccelerometerMatchesThePoses) {
  const auto folder = data / "tum_fr1_rpy_kinect_640x480";
  const auto recording = io::open_recording(folder);
  EXPECT_EQ(recording->info().times_source, "poses.tum");
  const Trajectory poses = read_trajectory(folder / "poses.tum");
  std::vector<double> angles_deg;
  for (int i = 0; i < recording->frame_count(); i += 10) {
    const std::optional<Gravity> gravity = recording->frame(i).gravity;
    ASSERT_TRUE(gravity) << i;
    angles_deg.push_back(off_deg(*gravity, poses.poses[i]));
  }
  std::ranges::sort(angles_deg);
  EXPECT_LE(angles_deg[angles_deg.size() / 2], 5);
  EXPECT_LE(angles_deg.back(), 9);
}

// Turned by hand above a desk, compared with motion capture. A third of the frames do not see the
// floor, and their own estimates are missing or wrong.
TEST_F(RealGravity, OfADeskIsKnownForEveryFrameAndNeverFarOff) {
  const std::filesystem::path path = data / "tum_fr1_rpy_kinect_640x480";
  io::RecordingOptions options;
  options.intrinsics = {517.3, 516.5, 318.6, 255.3};
  options.depth_unit_m = 0.0002;
  const std::shared_ptr<const io::Recording> recording = io::open_recording(path, options);
  const Trajectory truth = read_trajectory(path / "poses.tum");
  ASSERT_EQ(static_cast<int>(truth.poses.size()), recording->frame_count());
  const SequenceGravity gravity(recording, {});
  int carried = 0;
  double most_deg = 0;
  for (int i = 0; i < recording->frame_count(); i += 25) {
    Frame frame = recording->frame(i);
    frame.gravity.reset();
    gravity.resolve(frame);
    ASSERT_TRUE(frame.gravity) << "frame " << i;
    carried += frame.gravity->source == GravitySource::carried;
    most_deg = std::max(most_deg, off_deg(*frame.gravity, truth.poses[i]));
  }
  EXPECT_GE(carried, 4);
  EXPECT_LE(most_deg, 7);  // 6.3 over all 300 frames
}

}  // namespace
}  // namespace planescope::world
