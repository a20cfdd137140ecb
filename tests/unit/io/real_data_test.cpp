// Tests of the readers on real recordings; skipped unless PLANESCOPE_DATA is set.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/io/bag/message_log.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

/// Opens a recording in PLANESCOPE_DATA; skips the test if it is missing.
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

TEST_F(RealRecordings, TheSdksDb3HasThePixelsOfItsBag) {
  const auto bag = open("realsense_sdk_bag/single_depth_color_640x480.bag");
  for (const std::string dialect : {"plain", "zstd"}) {
    SCOPED_TRACE(dialect);
    const auto db3 = open("realsense_sdk_db3/" + dialect + "_single_depth_color_640x480.db3");
    EXPECT_EQ(db3->info().device, bag->info().device);
    EXPECT_EQ(db3->info().depth_unit_m, bag->info().depth_unit_m);
    EXPECT_EQ(db3->info().color_note, bag->info().color_note);
    EXPECT_TRUE(db3->info().warnings.empty());
    // The SDK's strings have six digits.
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

TEST_F(RealRecordings, McapOfRos2BagListsItsTopicsAndHasNoDepth) {
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

TEST_F(RealRecordings, ViewerExportOpensByEachOfItsFiles) {
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
  EXPECT_NE(message.find("8-bit PNG with 3 channels"), std::string::npos) << message;
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

}  // namespace
}  // namespace planescope::io
