#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/io/bag/message_log.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

/// Opens a recording of the real-data folder; skips the test where there is none.
class RealRecordings : public testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("PLANESCOPE_DATA");
    if (!root) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
    root_ = root;
  }
  std::unique_ptr<Recording> open(const std::string& path, const RecordingOptions& options = {}) {
    return open_recording(root_ / path, options);
  }
  std::filesystem::path root_;
};

std::size_t measured(const Frame& frame) {
  return frame.depth.pixels() -
         static_cast<std::size_t>(std::count(frame.depth.data.begin(), frame.depth.data.end(), 0));
}

TEST_F(RealRecordings, RealSenseSdkBag) {
  const auto recording = open("realsense_sdk_bag/single_depth_color_640x480.bag");
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(info.format, "RealSense SDK bag");
  EXPECT_EQ(info.device, "Intel RealSense D435");
  EXPECT_EQ(info.depth_unit_m, 0.001);
  EXPECT_EQ(info.depth_unit_source, "bag topic /device_0/sensor_0/option/Depth Units/value");
  EXPECT_NEAR(info.intrinsics.fx, 390.43145751953125, 1e-9);
  EXPECT_NEAR(info.intrinsics.cy, 242.18734741210938, 1e-9);
  EXPECT_EQ(info.color_note, "projected by extrinsics");
  EXPECT_TRUE(info.warnings.empty());
  ASSERT_EQ(recording->frame_count(), 2);
  const Frame frame = recording->frame(0);
  EXPECT_EQ(frame.name, "169");
  EXPECT_NEAR(frame.timestamp_s, 360.815089, 1e-6);
  EXPECT_EQ(recording->frame(1).name, "170");
  ASSERT_EQ(frame.color.width, 640);
  EXPECT_NEAR(frame.color_intrinsics.fx, 613.2036743164062, 1e-9);
  EXPECT_NEAR(frame.T_color_depth.translation().x(), 0.01431131362915039, 1e-9);
  EXPECT_FALSE(frame.color_aligned);
  EXPECT_GT(measured(frame), 100000u);
  EXPECT_FALSE(frame.gravity);
}

TEST_F(RealRecordings, TheSdksDb3GivesThePixelsOfTheBagItWasMadeOf) {
  const auto bag = open("realsense_sdk_bag/single_depth_color_640x480.bag");
  for (const std::string dialect : {"plain", "zstd"}) {
    SCOPED_TRACE(dialect);
    const auto db3 = open("realsense_sdk_db3/" + dialect + "_single_depth_color_640x480.db3");
    EXPECT_EQ(db3->info().device, bag->info().device);
    EXPECT_EQ(db3->info().depth_unit_m, bag->info().depth_unit_m);
    EXPECT_EQ(db3->info().color_note, bag->info().color_note);
    EXPECT_TRUE(db3->info().warnings.empty());
    // The SDK's texts have six digits.
    EXPECT_NEAR(db3->info().intrinsics.fx, bag->info().intrinsics.fx, 5e-4);
    EXPECT_NEAR(db3->info().intrinsics.cy, bag->info().intrinsics.cy, 5e-4);
    ASSERT_EQ(db3->frame_count(), bag->frame_count());
    for (int i = 0; i < bag->frame_count(); ++i) {
      const Frame ours = db3->frame(i), theirs = bag->frame(i);
      EXPECT_EQ(ours.name, theirs.name);
      EXPECT_NEAR(ours.timestamp_s, theirs.timestamp_s, 1e-6);
      EXPECT_EQ(ours.depth_unit_m, theirs.depth_unit_m);
      EXPECT_EQ(ours.depth.data, theirs.depth.data);
      EXPECT_EQ(db3->frame_hash(i), bag->frame_hash(i));
      EXPECT_EQ(ours.color.data, theirs.color.data);
      EXPECT_TRUE(ours.T_color_depth.isApprox(theirs.T_color_depth, 1e-5));
    }
  }
}

TEST_F(RealRecordings, McapOfRos2BagOpensAsFarAsItsTopicsAndHasNoDepth) {
  const auto refusal = [&](const std::string& name) {
    return message_of([&] { open("ros2_containers/" + name); });
  };
  expect_one_line_with(refusal("mcap_cdr_test/cdr_test_0.mcap"), {"no depth images"});
  expect_one_line_with(refusal("sqlite3_cdr_test/cdr_test_0.db3"), {"no depth images"});
  expect_one_line_with(refusal("topics_and_services.mcap"), {"no depth images"});
  const auto log = open_message_log(root_ / "ros2_containers/mcap_cdr_test/cdr_test_0.mcap");
  const auto same = open_message_log(root_ / "ros2_containers/sqlite3_cdr_test/cdr_test_0.db3");
  EXPECT_TRUE(log->warnings().empty());
  EXPECT_EQ(log->topics(), same->topics());
  for (const auto& [topic, type] : same->topics()) {
    const auto ours = log->messages(topic), theirs = same->messages(topic);
    ASSERT_EQ(ours.size(), theirs.size()) << topic;
    for (std::size_t i = 0; i < ours.size(); ++i)
      EXPECT_TRUE(std::ranges::equal(log->read(ours[i]).bytes, same->read(theirs[i]).bytes));
  }
}

TEST_F(RealRecordings, TheFolderOfASingleBagOpensTheBag) {
  EXPECT_EQ(open("realsense_sdk_bag")->frame_count(), 2);
}

TEST_F(RealRecordings, FolderWithOpen3dIntrinsics) {
  const auto recording = open("felixchenfy_d4xx_640x480");
  EXPECT_EQ(recording->frame_count(), 5);
  EXPECT_EQ(recording->info().intrinsics.fx, 617.25);
  EXPECT_NEAR(recording->info().intrinsics.cx, 317.3921203613281, 1e-12);
  EXPECT_NEAR(recording->info().intrinsics.cy, 245.98019409179688, 1e-12);
  EXPECT_EQ(recording->info().intrinsics_source, "cam_params_realsense.json");
  EXPECT_EQ(recording->info().depth_unit_source, "assumed (RealSense default)");
  const Frame frame = recording->frame(2);
  EXPECT_EQ(frame.name, "000003");
  EXPECT_TRUE(frame.color_aligned);
  EXPECT_EQ(recording->info().color_note, "assumed aligned (same size, one set of intrinsics)");
  EXPECT_EQ(recording->frame_hash(0).size(), 64u);
  EXPECT_NE(recording->frame_hash(0), recording->frame_hash(1));
}

TEST_F(RealRecordings, FolderWithoutIntrinsicsAsksForThem) {
  const std::string message = message_of([&] { open("aims_slam_realsense_640x480"); });
  EXPECT_NE(message.find("--intrinsics"), std::string::npos) << message;
  const auto recording =
      open("aims_slam_realsense_640x480", with_intrinsics(383.8, 383.8, 321.7, 236.8));
  ASSERT_EQ(recording->frame_count(), 40);
  EXPECT_EQ(recording->frame(0).name, "15");
  EXPECT_EQ(recording->frame(39).name, "54");
  EXPECT_EQ(recording->frame(39).color.width, 640);
}

TEST_F(RealRecordings, ColourIsPairedThoughItsNamesDifferFromThoseOfDepth) {
  const auto recording = open("polylidar_d435i_424x240");
  ASSERT_EQ(recording->frame_count(), 4);
  EXPECT_EQ(recording->info().width, 424);
  const Frame frame = recording->frame(3);
  EXPECT_TRUE(frame.color_aligned);
  EXPECT_NEAR(frame.timestamp_s, 1580908154.939, 1e-3);
  EXPECT_EQ(measured(frame), frame.depth.pixels());
}

TEST_F(RealRecordings, ViewerExportOpensByEachOfItsPaths) {
  for (const char* path :
       {"rs_viewer_raw_export_848x480", "rs_viewer_raw_export_848x480/001_big_depth.raw",
        "rs_viewer_raw_export_848x480/001_big_depth_metadata.csv"}) {
    const auto recording = open(path);
    ASSERT_EQ(recording->frame_count(), 1) << path;
    EXPECT_EQ(recording->info().width, 848);
    EXPECT_NEAR(recording->info().intrinsics.cx, 425.867798, 1e-9);
    EXPECT_GT(measured(recording->frame(0)), 100000u);
    EXPECT_NEAR(recording->frame(0).timestamp_s, 1581812447.07136, 1e-5);
  }
  const std::string message =
      message_of([&] { open("rs_viewer_raw_export_848x480/001_big_depth.png"); });
  EXPECT_NE(message.find("3 channel(s) with 8 bits"), std::string::npos) << message;
}

TEST_F(RealRecordings, DepthBesideCloudAndUnalignedColour) {
  const RecordingOptions options = with_intrinsics(365.3177, 365.3174, 254.685, 208.549);
  const auto recording = open("stairs_kinect2_512x424", options);
  ASSERT_EQ(recording->frame_count(), 1);
  const Frame frame = recording->frame(0);
  EXPECT_EQ(frame.depth.width, 512);
  EXPECT_EQ(frame.color.width, 1920);
  EXPECT_FALSE(frame.color_aligned);
  EXPECT_EQ(frame.color_intrinsics.fx, 0);
  const auto cloud = open("stairs_kinect2_512x424/0000_cloud.pcd");
  EXPECT_EQ(cloud->frame(0).cloud->points.size(), 217088u);
  EXPECT_EQ(cloud->frame(0).cloud->rgb.size(), 3 * 217088u);
}

TEST_F(RealRecordings, CloudsInNestedFolders) {
  const auto recording = open("plane_seg_clouds");
  ASSERT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->frame(0).name, "terrain_med");
  EXPECT_EQ(recording->frame(0).cloud->points.size(), 68913u);
  EXPECT_EQ(recording->frame(1).name, "anymal/ori_entrance_stair_climb/06");
  // The compressed cloud: its landing lies at 1.27 m, its floor at 0.59 m.
  const auto points =
      open("plane_seg_clouds/anymal/ori_entrance_stair_climb/06.pcd")->frame(0).cloud->points;
  ASSERT_EQ(points.size(), 107772u);
  const auto near = [&](float z) {
    return std::count_if(points.begin(), points.end(),
                         [&](const Vec3f& p) { return std::abs(p.z() - z) < 0.02f; });
  };
  EXPECT_GT(near(0.59f), 3 * near(0.68f));
  EXPECT_GT(near(1.27f), 3 * near(1.19f));
}

TEST_F(RealRecordings, OpencvCalibrationWithDistortionAndExtrinsics) {
  const auto recording = open("cape_tunnel_structure_640x480");
  const Frame frame = recording->frame(0);
  EXPECT_NEAR(frame.intrinsics.fx, 575.9268544880447, 1e-9);
  EXPECT_NEAR(frame.intrinsics.fy, 576.4079160109325, 1e-9);
  EXPECT_NEAR(frame.intrinsics.cy, 230.58580662101753, 1e-9);
  EXPECT_EQ(frame.intrinsics.distortion, Distortion::brown_conrady);
  EXPECT_NEAR(frame.intrinsics.coefficients[4], -1.0147872415919272, 1e-12);
  EXPECT_NEAR(frame.color_intrinsics.fx, 548.86723733696215, 1e-9);
  EXPECT_NEAR(frame.T_color_depth.translation().y(), 0.035139088879273231, 1e-12);
  EXPECT_NEAR(frame.T_color_depth.linear()(0, 1), -0.011131100247700660, 1e-3);
  EXPECT_EQ(recording->info().color_note, "projected by extrinsics");
}

TEST_F(RealRecordings, TumFrameWithItsUnitAsOption) {
  RecordingOptions options = with_intrinsics(525, 525, 319.5, 239.5);
  options.depth_unit_m = 0.0002;
  const auto recording = open("tum_kinect_640x480", options);
  EXPECT_EQ(recording->info().depth_unit_source, "option --depth-unit");
  EXPECT_TRUE(recording->frame(0).color_aligned);
}

TEST_F(RealRecordings, TextMatrixWithNegativeFocalLength) {
  RecordingOptions options;
  options.depth_unit_m = 0.0002;
  const auto recording = open("NOT_REAL_icl_nuim_with_plane_gt", options);
  EXPECT_EQ(recording->info().intrinsics.fx, 481.2);
  EXPECT_EQ(recording->info().intrinsics.fy, 480);
  EXPECT_EQ(recording->info().intrinsics_source, "ICL_living_room.K");
  EXPECT_FALSE(recording->info().has_color);
}

TEST_F(RealRecordings, ASingleDepthImageFindsItsCalibrationAndColour) {
  const auto recording = open("felixchenfy_d4xx_640x480/depth/000004.png");
  ASSERT_EQ(recording->frame_count(), 1);
  EXPECT_EQ(recording->info().intrinsics.fx, 617.25);
  EXPECT_TRUE(recording->frame(0).color_aligned);
}

}  // namespace
}  // namespace planescope::io
